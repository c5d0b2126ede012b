"""Nanoseconds per evaluation and per sample of Mitsuba 3's `roughconductor` (Beckmann, visible normals), for the scale of
what `cargo bench -p spectral-tests --bench brdf` prints.

Compared: one thread, single precision, anisotropic roughness 0.1 and 0.2; lights drawn by the model's own sampling for
views uniform in the hemisphere. Mitsuba's numbers are of its LLVM mode, vectorised over a million directions and with
kernels compiled before the clock starts; they include Fresnel factors for three channels (gold), shadowing and, for a
sample, its density and weight. Ours are scalar calls.

Run: python roughconductor_speed.py (LLVM 15 lacks instructions that Dr.Jit wants; DRJIT_LIBLLVM_PATH names a newer one)
"""
import time

import drjit as dr
import mitsuba as mi

COUNT = 1 << 20
ROUNDS = 10


def best(work):
    work()
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times) / COUNT * 1e9


def main():
    mi.set_variant("llvm_ad_rgb")
    dr.set_thread_count(1)
    bsdf = mi.load_dict({"type": "roughconductor", "material": "Au", "distribution": "beckmann", "alpha_u": 0.1, "alpha_v": 0.2})
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(1, COUNT)
    context = mi.BSDFContext()
    si = dr.zeros(mi.SurfaceInteraction3f, COUNT)
    si.wi = mi.warp.square_to_uniform_hemisphere(sampler.next_2d())
    u1, u2 = sampler.next_1d(), sampler.next_2d()
    light = bsdf.sample(context, si, u1, u2)[0].wo
    dr.eval(si, u1, u2, light)
    dr.sync_thread()

    def evaluate():
        dr.eval(bsdf.eval(context, si, light))
        dr.sync_thread()

    def density():
        dr.eval(bsdf.pdf(context, si, light))
        dr.sync_thread()

    def sample():
        drawn, weight = bsdf.sample(context, si, u1, u2)
        dr.eval(drawn.wo, drawn.pdf, weight)
        dr.sync_thread()

    print(f"mitsuba {mi.__version__}, {mi.variant()}, one thread, {COUNT} directions")
    for name, work in (("evaluate", evaluate), ("pdf", density), ("sample", sample)):
        print(f"{name}: {best(work):.1f} ns")


if __name__ == "__main__":
    main()

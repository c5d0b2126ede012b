/*
 * What a lamp's own computer may want to know of it: colour, colour rendering, and the light of a disk that it feeds.
 *
 *     cargo build --release
 *     cc -std=c99 -Iinclude examples/lamp.c target/release/libspectral_c.a -lm -o lamp && ./lamp
 */
#include <stdio.h>
#include <stdlib.h>

#include "spectral.h"

/* Ends the program with what is wrong. */
static void check(const char *what, SpectralStatus status) {
    if (status == SPECTRAL_STATUS_OK) return;
    fprintf(stderr, "%s: %s\n", what, spectral_status_text(status));
    exit(EXIT_FAILURE);
}

/* A blue diode with a phosphor, measured at 20 nm: wavelengths in nm, power of any unit. */
static const float wavelengths[] = {380, 400, 420, 440, 460, 480, 500, 520, 540, 560, 580,
                                    600, 620, 640, 660, 680, 700, 720, 740, 760, 780};
static const float powers[] = {0, 1, 9, 58, 71, 28, 33, 52, 66, 76, 84, 88, 82, 68, 50, 34, 22, 13, 8, 5, 3};
static const float leaf[] = {5, 5, 5, 5, 6, 7, 10, 17, 21, 18, 13, 11, 10, 9, 8, 9, 28, 45, 49, 50, 50};

static SpectralSpectrum_f32 spectrum(const float *values, SpectralOutside outside) {
    SpectralSpectrum_f32 result;
    result.wavelengths = wavelengths;
    result.values = values;
    result.count = sizeof wavelengths / sizeof wavelengths[0];
    result.outside = outside;
    return result;
}

static void colour_rendering(const SpectralSpectrum_f32 *lamp) {
    static float samples[401];
    SpectralIndices_f32 found;
    check("sampling", spectral_sample_f32(lamp, 401, samples));
    check("measuring", spectral_light_indices_f32(samples, 401, &found));
    printf("colour temperature  %.0f K, Duv %+.4f\n", (double)found.chromaticity.cct, (double)found.chromaticity.duv);
    printf("Ra, CRI00           %.1f, %.1f\n", (double)found.ra, (double)found.cri00);
}

/* Its light on a leaf, to within a colour difference that nobody sees. */
static void reflected(const SpectralSpectrum_f32 *lamp) {
    static SpectralWorkspace_f32 workspace;
    float reflectances[sizeof leaf / sizeof leaf[0]], lab[3];
    SpectralSpectrum_f32 paint;
    SpectralTarget_f32 target = {0.5F, {0}, SPECTRAL_MODE_CERTIFIED, SPECTRAL_OBSERVER_CIE1931, SPECTRAL_MOST_INTERVALS};
    SpectralProduct_f32 found;
    size_t i;
    for (i = 0; i < sizeof leaf / sizeof leaf[0]; i++) reflectances[i] = leaf[i] / 100;
    paint = spectrum(reflectances, SPECTRAL_OUTSIDE_HOLD);
    check("white", spectral_tristimulus_f32(lamp, target.observer, target.white));
    check("reflecting", spectral_product_f32(lamp, &paint, 1, &target, &workspace, NULL, 0, &found));
    check("CIELAB", spectral_xyz_to_lab_f32(found.xyz, target.white, lab));
    printf("a leaf under it     L* %.1f, a* %.1f, b* %.1f, certainly within %.2f, by %d intervals\n", (double)lab[0],
           (double)lab[1], (double)lab[2], (double)found.delta_e, (int)found.intervals);
}

/* A disk of 0.4 m radius and 5000 lm/m2, 3.55 m over the floor: 62.7 lx. */
static void illuminance(void) {
    const SpectralDisk_f32 disk = {{0, 0, 3.55F}, {0, 0, -1}, 0.4F};
    const SpectralReceiver_f32 floor = {{0, 0, 0}, {0, 0, 1}};
    float factor;
    check("illuminating", spectral_disk_factor_f32(&disk, &floor, &factor));
    printf("on the floor        %.2f lx\n", 5000.0 * (double)factor);
}

int main(void) {
    const SpectralSpectrum_f32 lamp = spectrum(powers, SPECTRAL_OUTSIDE_ZERO);
    colour_rendering(&lamp);
    reflected(&lamp);
    illuminance();
    return 0;
}

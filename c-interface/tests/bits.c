/*
 * Calls every function with numbers of a generator and prints the bits of all results; examples/bits.rs prints what the Rust
 * crates answer to the same numbers.
 */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "spectral.h"

/* How often, with other numbers each time. */
#ifndef ROUNDS
#define ROUNDS 20
#endif

static uint64_t state;

/* A number in [0, 1) of 24 bits, exact in float. */
static double next(void) {
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 40) / 16777216.0;
}

static double between(double from, double to) {
    return from + (to - from) * next();
}

static void print(const char *name, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    if (value != value) bits = UINT64_C(0x7ff8000000000000);
    /* In halves, which every C library can print. */
    printf("%s %08lx%08lx\n", name, (unsigned long)(bits >> 32), (unsigned long)(bits & 0xffffffffU));
}

static int refused;

static void done(const char *name, SpectralStatus status) {
    if (status != SPECTRAL_STATUS_OK) {
        fprintf(stderr, "%s: %s\n", name, spectral_status_text(status));
        refused += 1;
    }
}

#define REAL float
#define OF(name) name##_f32
#include "bits.inc"
#undef REAL
#undef OF

#define REAL double
#define OF(name) name##_f64
#include "bits.inc"

int main(void) {
    state = 1;
    all_f32();
    state = 1;
    all_f64();
    return refused > 0;
}

/* What every function refuses, and that it then has written nothing. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "spectral.h"

static int passed, failed;

/* Whether a call was refused as it should be, with all results still filled with the byte they were filled with. */
static void verdict(const char *call, int line, SpectralStatus status, SpectralStatus expected, const void *results,
                    size_t size) {
    const unsigned char *bytes = results;
    size_t i;
    int untouched = 1;
    for (i = 0; i < size; i++) untouched = untouched && bytes[i] == 0xA5;
    if (status == expected && untouched) {
        passed += 1;
        return;
    }
    failed += 1;
    fprintf(stderr, "refusals.inc:%d: %s\n    %s, where it should be: %s%s\n", line, call, spectral_status_text(status),
            spectral_status_text(expected), untouched ? "" : "; results were written");
}

/* A pointer that is not aligned for numbers. */
#define ASKEW(pointer) ((void *)((char *)(pointer) + 1))

#define REAL float
#define OF(name) name##_f32
#include "refusals.inc"
#undef REAL
#undef OF

#define REAL double
#define OF(name) name##_f64
#include "refusals.inc"

static void texts(void) {
    int32_t status;
    for (status = -1; status <= 13; status++) {
        const char *text = spectral_status_text(status);
        int known = status >= 0 && status <= SPECTRAL_STATUS_RESPONSE;
        if (text != NULL && (strcmp(text, "an unknown status") != 0) == known) {
            passed += 1;
        } else {
            failed += 1;
        }
    }
}

int main(void) {
    texts();
    refusals_f32();
    refusals_f64();
    printf("%d passed, %d failed\n", passed, failed);
    return failed > 0;
}

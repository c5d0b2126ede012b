/* What a Cortex-M4F needs before and after main on QEMU's mps2-an386; newlib's semihosting does the printing. */
#include <stdint.h>
#include <stdlib.h>

extern uint32_t __stack[], __bss_start__[], __bss_end__[];
extern void initialise_monitor_handles(void);
int main(void);

static void reset(void) {
    volatile uint32_t *access = (volatile uint32_t *)0xE000ED88;
    uint32_t *word;
    *access |= 0xFU << 20; /* the floating-point unit */
    __asm__ volatile("dsb\n\tisb");
    for (word = __bss_start__; word < __bss_end__; word++) *word = 0;
    initialise_monitor_handles();
    exit(main());
}

static void fault(void) {
    abort();
}

__attribute__((section(".vectors"), used)) static const uintptr_t vectors[16] = {
    (uintptr_t)__stack, (uintptr_t)reset, (uintptr_t)fault, (uintptr_t)fault,
    (uintptr_t)fault,   (uintptr_t)fault, (uintptr_t)fault,
};

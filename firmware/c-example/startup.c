/*
 * Any Cortex-M under QEMU: vectors, memory, the FPU where there is one, and newlib's semihosting for printf and exit.
 * The board's addresses come from the linker's command line: see run.
 */
#include <stdint.h>
#include <stdlib.h>

extern uint32_t __data_load[], __data_start__[], __data_end__[], __bss_start__[], __bss_end__[], __stack[];
extern int main(void);
extern void initialise_monitor_handles(void);

static void failed(void) {
    _Exit(3);
}

void reset(void) {
#if defined(__ARM_FP)
    *(volatile uint32_t *)0xE000ED88u |= 0x00F00000u; /* CPACR: the FPU, off after reset */
    __asm volatile("dsb\n isb");
#endif
    uint32_t *from = __data_load;
    for (uint32_t *to = __data_start__; to < __data_end__;) {
        *to++ = *from++;
    }
    for (uint32_t *to = __bss_start__; to < __bss_end__;) {
        *to++ = 0;
    }
    initialise_monitor_handles();
    exit(main());
}

/* newlib's exit wants them, and we have no constructors */
void _init(void) {}
void _fini(void) {}

__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    (void (*)(void))__stack, reset,  failed, failed, failed, failed, failed, failed,
    failed,                  failed, failed, failed, failed, failed, failed, failed,
};

//! The stack's high-water mark: the memory below the stack pointer is painted, and what lost its paint was used.

/// What untouched memory holds.
const PAINT: u32 = 0x5AFE_5AFE;

/// Words that are painted, and words just below the stack pointer that are not: this function's own.
const WORDS: usize = 1500;
const OWN: usize = 16;

/// Runs `work` and returns how many bytes of stack it took below this function's frame, rounded up to a word and by at most
/// the 16 words that are left unpainted.
///
/// No interrupt may use the stack meanwhile; on these boards none is enabled.
#[inline(never)]
pub fn high_water(stack_pointer: fn() -> usize, work: impl FnOnce()) -> usize {
    let top = stack_pointer() - 4 * OWN;
    for word in 0..WORDS {
        // SAFETY: 6 KB below the stack pointer, which every board here has free (the smallest has 16 KB of RAM); nothing
        // lives there, and the writes stay below this function's frame
        unsafe { ((top - 4 * word) as *mut u32).write_volatile(PAINT) };
    }
    work();
    let mut used = WORDS;
    while used > 0 {
        // SAFETY: reads of the words painted above
        let word = unsafe { ((top - 4 * (used - 1)) as *const u32).read_volatile() };
        if word != PAINT {
            break;
        }
        used -= 1;
    }
    4 * (used + OWN)
}

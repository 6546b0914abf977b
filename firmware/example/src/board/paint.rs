//! The stack's high-water mark: the memory below the stack pointer is painted, and what lost its paint was used.

/// What untouched memory holds.
const PAINT: u32 = 0x5AFE_5AFE;

/// Words that are painted.
const WORDS: usize = 1500;

/// Runs `work` and returns how many bytes of stack it took below this function's frame, to the word.
///
/// `stack_pointer` must be inlined, so that it tells this function's own. No interrupt may use the stack meanwhile; on these
/// boards none is enabled.
#[inline(never)]
pub fn high_water(stack_pointer: impl Fn() -> usize, work: impl FnOnce()) -> usize {
    let top = stack_pointer();
    for word in 1..=WORDS {
        // SAFETY: 6 KB below the stack pointer, which every board here has free (the smallest has 16 KB of RAM); nothing
        // lives there, and this loop calls nothing
        unsafe { ((top - 4 * word) as *mut u32).write_volatile(PAINT) };
    }
    work();
    let mut used = WORDS;
    while used > 0 {
        // SAFETY: reads of the words painted above
        let word = unsafe { ((top - 4 * used) as *const u32).read_volatile() };
        if word != PAINT {
            break;
        }
        used -= 1;
    }
    4 * used
}

//! LIST arguments: `10,20,30`, `0:80:10`, or both: `0:80:10,85,89`.

use std::str::FromStr;

/// The longest list that one argument may spell.
const LONGEST: usize = 10_000_000;

/// Numbers as given on the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct List(pub Vec<f64>);

impl FromStr for List {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut numbers = Vec::new();
        for part in text.split(',') {
            let fields: Vec<&str> = part.split(':').map(str::trim).collect();
            match fields.as_slice() {
                [number] => numbers.push(Decimal::parse(number)?.value),
                [first, last] => range(&mut numbers, first, last, "1")?,
                [first, last, step] => range(&mut numbers, first, last, step)?,
                _ => return Err(format!("{part:?}: expected a number or FIRST:LAST:STEP")),
            }
        }
        Ok(List(numbers))
    }
}

/// FIRST, FIRST + STEP, … up to LAST, LAST included where a step meets it.
fn range(numbers: &mut Vec<f64>, first: &str, last: &str, step: &str) -> Result<(), String> {
    let [first, last, step] = [Decimal::parse(first)?, Decimal::parse(last)?, Decimal::parse(step)?];
    let span = (last.value - first.value) / step.value;
    if step.value == 0.0 || span < 0.0 {
        let (first, last, step) = (first.value, last.value, step.value);
        return Err(format!("{first}:{last}:{step} never arrives: expected a STEP that leads from FIRST to LAST"));
    }
    // Half a millionth of a step: 0:1:0.1 has eleven numbers although 1/0.1 may come out below 10.
    let steps = (span + 5e-7).floor();
    if numbers.len() as f64 + steps >= LONGEST as f64 {
        return Err(format!("expected at most {LONGEST} numbers"));
    }
    let decimals = first.decimals.max(step.decimals);
    numbers.extend((0..=steps as u64).map(|index| first.plus(index as f64, step, decimals)));
    Ok(())
}

/// A number and how many decimals it was written with; `None` where it has an exponent or too many digits.
#[derive(Clone, Copy)]
struct Decimal {
    value: f64,
    decimals: Option<i32>,
}

impl Decimal {
    fn parse(text: &str) -> Result<Self, String> {
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        let value = value.ok_or_else(|| format!("{text:?} is no number: expected 10,20,30 or FIRST:LAST:STEP"))?;
        let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let plain = text.len() <= 15 && !text.contains(['e', 'E']);
        Ok(Decimal { value, decimals: plain.then_some(decimals as i32) })
    }

    /// first + index · step as one would write it: 0.3, not 0.30000000000000004.
    ///
    /// In units of the last decimal all three are whole numbers, exact in a double; one division rounds once.
    fn plus(self, index: f64, step: Decimal, decimals: Option<i32>) -> f64 {
        if let (Some(_), Some(_), Some(decimals)) = (self.decimals, step.decimals, decimals) {
            let unit = 10_f64.powi(decimals);
            let whole = (self.value * unit).round() + index * (step.value * unit).round();
            if whole.abs() < 9e15 {
                return whole / unit;
            }
        }
        self.value + index * step.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(text: &str) -> Vec<f64> {
        text.parse::<List>().unwrap().0
    }

    #[test]
    fn lists_and_ranges_spell_the_same_numbers() {
        assert_eq!(list("10,20,30"), list("10:30:10"));
        assert_eq!(list("0:3"), [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(list("-180:180:90"), [-180.0, -90.0, 0.0, 90.0, 180.0]);
        assert_eq!(list("0:20:10,85,89"), [0.0, 10.0, 20.0, 85.0, 89.0]);
        assert_eq!(list("30:0:-15"), [30.0, 15.0, 0.0]);
        assert_eq!(list("5:5:1"), [5.0]);
        assert_eq!(list("0:10:4"), [0.0, 4.0, 8.0]);
    }

    #[test]
    fn steps_of_decimals_are_the_decimals() {
        assert_eq!(list("0:1:0.1"), [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]);
        assert_eq!(list("1.05:1.11:0.02"), [1.05, 1.07, 1.09, 1.11]);
        assert_eq!(list("0:1:0.001").len(), 1001);
    }

    #[test]
    fn what_is_no_list_is_named() {
        for text in ["", "a", "1,,2", "1:2:3:4", "0:10:0", "0:10:-1", "nan", "1:inf", "0:1e9:0.001"] {
            assert!(text.parse::<List>().is_err(), "{text:?}");
        }
    }
}

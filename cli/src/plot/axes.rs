//! Axes with round ticks and units, and the frame they make.

use super::style::{GRID, HAIR, Marker, SMALL_PX, TEXT_PX};
use super::svg::{Stroke, Svg, TextStyle, number};

/// The unit of an axis: every axis has one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// nm
    Nm,
    /// degrees
    Degrees,
    /// sr⁻¹
    PerSr,
    /// a pure number
    Unitless,
    /// percent
    Percent,
}

impl Unit {
    /// As it stands in brackets.
    pub fn name(self) -> &'static str {
        match self {
            Unit::Nm => "nm",
            Unit::Degrees => "°",
            Unit::PerSr => "sr⁻¹",
            Unit::Unitless => "unitless",
            Unit::Percent => "%",
        }
    }
}

/// One axis: a range, ticks and a label.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Value at the left or bottom end.
    pub from: f64,
    /// Value at the right or top end.
    pub to: f64,
    /// Equal factors are equal distances.
    pub logarithmic: bool,
    /// Where the ticks stand.
    pub ticks: Vec<f64>,
    /// Quantity and unit.
    pub label: String,
}

impl Axis {
    /// From `from` to `to` as they are, with about `count` round ticks.
    pub fn exact(quantity: &str, unit: Unit, from: f64, to: f64, count: usize) -> Self {
        Self::stepped(quantity, unit, [from, to], round_step((to - from) / count.max(1) as f64))
    }

    /// With a tick at every multiple of `step`.
    fn stepped(quantity: &str, unit: Unit, [from, to]: [f64; 2], step: f64) -> Self {
        let first = (from / step - 1e-9).ceil();
        let ticks = (0..100).map(|i| (first + f64::from(i)) * step).take_while(|tick| *tick <= to + 1e-9 * step);
        let label = format!("{quantity} ({})", unit.name());
        Axis { from, to, logarithmic: false, ticks: ticks.collect(), label }
    }

    /// Around the finite ones of some values, from tick to tick.
    pub fn around(quantity: &str, unit: Unit, values: impl IntoIterator<Item = f64>, count: usize) -> Self {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.into_iter().filter(|value| value.is_finite()) {
            (least, most) = (least.min(value), most.max(value));
        }
        if !(least <= most) {
            (least, most) = (0.0, 1.0);
        }
        // values that are all but equal still get an axis: a hundredth of their size
        let smallest = (0.01 * least.abs().max(most.abs())).max(1e-12);
        if most - least < smallest {
            (least, most) = (least - 0.5 * smallest, most + 0.5 * smallest);
        }
        let step = round_step((most - least) / count.max(1) as f64);
        Self::stepped(quantity, unit, [(least / step).floor() * step, (most / step).ceil() * step], step)
    }

    /// From `from` to `to`, logarithmic, with ticks at 1, 2, 5 of each decade.
    pub fn logarithmic(quantity: &str, unit: Unit, from: f64, to: f64) -> Self {
        let mut ticks = Vec::new();
        let decades = from.log10().floor() as i32..=to.log10().ceil() as i32;
        for decade in decades {
            for digit in [1.0, 2.0, 5.0] {
                ticks.push(digit * 10.0_f64.powi(decade));
            }
        }
        let inside = |tick: &f64| *tick >= from * (1.0 - 1e-9) && *tick <= to * (1.0 + 1e-9);
        ticks.retain(inside);
        if ticks.len() < 3 {
            ticks = Self::exact(quantity, unit, from, to, 4).ticks;
        }
        Axis { from, to, logarithmic: true, ticks, label: format!("{quantity} ({})", unit.name()) }
    }

    /// Where a value stands: 0 at the axis' start, 1 at its end.
    pub fn part(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        }
    }

    /// The value of a part.
    pub fn value(&self, part: f64) -> f64 {
        if self.logarithmic {
            self.from * (self.to / self.from).powf(part)
        } else {
            self.from + part * (self.to - self.from)
        }
    }

    /// Ticks as text, all with the decimals that the finest needs.
    pub fn tick_labels(&self) -> Vec<String> {
        labels(&self.ticks)
    }
}

/// 1, 2 or 5 times a power of ten: the least that is not below `rough`.
fn round_step(rough: f64) -> f64 {
    let power = 10.0_f64.powf(rough.max(1e-300).log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power);
    steps.into_iter().find(|step| *step >= rough * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

/// The least round number (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8 × a power of ten) that is not below a value.
pub fn round_up(value: f64) -> f64 {
    let power = 10.0_f64.powf(value.max(1e-300).log10().floor());
    let digits = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    digits.map(|digit| digit * power).into_iter().find(|round| *round >= value * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

/// Below this all numbers of an axis have an exponent: six decimals would not fit beside it, nor tell them apart.
const SMALL: f64 = 1e-3;

/// Numbers as text, with the decimals that tell the nearest two apart; a true minus sign.
pub fn labels(values: &[f64]) -> Vec<String> {
    let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    if largest > 0.0 && largest < SMALL {
        let written = |value: f64, digits: usize| format!("{value:.digits$e}");
        let exact = |digits: &usize| {
            let back = |value: f64| written(value, *digits).parse().unwrap_or(f64::NAN);
            values.iter().all(|value| (back(*value) - value).abs() < 1e-6 * largest)
        };
        let digits = (0..3).find(exact).unwrap_or(3);
        // what is left of 0 after a walk in steps is 0
        let label = |value: &f64| {
            if value.abs() < 1e-9 * largest { "0".to_string() } else { written(*value, digits).replace('-', "−") }
        };
        return values.iter().map(label).collect();
    }
    let decimals = values.iter().map(|value| {
        let exact = |digits: &usize| {
            let scaled = value * 10.0_f64.powi(*digits as i32);
            (scaled - scaled.round()).abs() < 1e-6 * scaled.abs().max(1e-3)
        };
        (0..7).find(exact).unwrap_or(6)
    });
    let decimals = decimals.max().unwrap_or(0);
    values.iter().map(|value| format!("{:.decimals$}", value + 0.0).replace('-', "−")).collect()
}

/// Two axes and the rectangle between them, px.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Width.
    pub width: f64,
    /// Height.
    pub height: f64,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
}

impl Frame {
    /// Where a pair of values stands, px.
    pub fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [self.left + self.x.part(x) * self.width, self.top + (1.0 - self.y.part(y)) * self.height]
    }

    /// The rectangle as a path, `grown` px larger on every side.
    pub fn outline(&self, grown: f64) -> String {
        let [left, right] = [self.left - grown, self.left + self.width + grown].map(number);
        let [top, bottom] = [self.top - grown, self.top + self.height + grown].map(number);
        format!("M{left} {top}H{right}V{bottom}H{left}Z")
    }

    /// Grid lines: draw them before the values.
    pub fn grid(&self, svg: &mut Svg) {
        for tick in &self.x.ticks {
            let [x, _] = self.at(*tick, self.y.from);
            svg.line([x, self.top], [x, self.top + self.height], GRID);
        }
        for tick in &self.y.ticks {
            let [_, y] = self.at(self.x.from, *tick);
            svg.line([self.left, y], [self.left + self.width, y], GRID);
        }
    }

    /// Outline, ticks and labels: draw them after the values. Without `x_label` the lower axis has ticks only.
    pub fn axes(&self, svg: &mut Svg, x_label: bool, y_label: bool) {
        svg.outline(&self.outline(0.0), HAIR);
        let bottom = self.top + self.height;
        let small = TextStyle { size: SMALL_PX, ..TextStyle::middle() };
        for (tick, label) in self.x.ticks.iter().zip(self.x.tick_labels()) {
            let [x, _] = self.at(*tick, self.y.from);
            svg.line([x, bottom], [x, bottom + 5.0], HAIR);
            if x_label {
                svg.text([x, bottom + 6.0 + SMALL_PX], &label, small);
            }
        }
        let mut widest = 0;
        for (tick, label) in self.y.ticks.iter().zip(self.y.tick_labels()) {
            let [_, y] = self.at(self.x.from, *tick);
            svg.line([self.left - 5.0, y], [self.left, y], HAIR);
            widest = widest.max(label.chars().count());
            svg.text([self.left - 8.0, y + 0.36 * SMALL_PX], &label, TextStyle { size: SMALL_PX, ..TextStyle::end() });
        }
        if x_label {
            let middle = self.left + 0.5 * self.width;
            let style = TextStyle { class: "axis-label", ..TextStyle::middle() };
            svg.text([middle, bottom + 12.0 + SMALL_PX + TEXT_PX], &self.x.label, style);
        }
        if y_label {
            let x = self.left - 8.0 - 0.64 * SMALL_PX * widest as f64 - 10.0;
            let style = TextStyle { class: "axis-label", upwards: true, ..TextStyle::middle() };
            svg.text([x, self.top + 0.5 * self.height], &self.y.label, style);
        }
    }

    /// A heading above the frame, at its left edge.
    pub fn heading(&self, svg: &mut Svg, text: &str) {
        svg.text([self.left, self.top - 9.0], text, TextStyle { bold: true, ..TextStyle::default() });
    }

    /// A line through pairs of values, inside the frame.
    pub fn line(&self, svg: &mut Svg, points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke<'_>) {
        svg.polyline(points.into_iter().map(|[x, y]| self.at(x, y)), stroke);
    }

    /// The band between two values at each x (an error band); broken where one of them is no number.
    pub fn band(&self, svg: &mut Svg, rows: &[[f64; 3]], colour: &str) {
        for run in rows.split(|row| row.iter().any(|value| !value.is_finite())) {
            let lower = run.iter().map(|[x, low, _]| self.at(*x, *low));
            let upper = run.iter().rev().map(|[x, _, high]| self.at(*x, *high));
            let mut data = String::new();
            for [x, y] in lower.chain(upper) {
                data.push(if data.is_empty() { 'M' } else { 'L' });
                data.push_str(&format!("{} {}", number(x), number(y)));
            }
            if !data.is_empty() {
                data.push('Z');
                svg.fill(&data, colour, 0.25);
            }
        }
    }
}

/// A marker's outline as a path.
pub fn marker(marker: Marker, [x, y]: [f64; 2], r: f64) -> String {
    let corners = |corners: &[[f64; 2]]| {
        let mut path = String::new();
        for [dx, dy] in corners {
            path.push(if path.is_empty() { 'M' } else { 'L' });
            path.push_str(&format!("{} {}", number(x + r * dx), number(y + r * dy)));
        }
        path.push('Z');
        path
    };
    match marker {
        Marker::Disc => {
            let (x0, x1, y, r) = (number(x - r), number(x + r), number(y), number(r));
            format!("M{x0} {y}A{r} {r} 0 1 0 {x1} {y}A{r} {r} 0 1 0 {x0} {y}Z")
        }
        Marker::Square => corners(&[[-0.87, -0.87], [0.87, -0.87], [0.87, 0.87], [-0.87, 0.87]]),
        Marker::Triangle => corners(&[[0.0, -1.2], [1.08, 0.75], [-1.08, 0.75]]),
        Marker::Diamond => corners(&[[0.0, -1.25], [1.05, 0.0], [0.0, 1.25], [-1.05, 0.0]]),
    }
}

/// Labels beside the right ends of lines, moved apart where they would touch: (y in px, text, colour).
pub fn end_labels(svg: &mut Svg, x: f64, mut labels: Vec<(f64, String, &str)>, [top, bottom]: [f64; 2]) {
    let gap = 1.25 * SMALL_PX;
    labels.retain(|(y, _, _)| y.is_finite());
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (place, y) in apart(labels.iter().map(|label| label.0).collect(), gap, top, bottom).into_iter().enumerate() {
        let (wanted, text, colour) = &labels[place];
        // a hair line from the line's end to a label that had to move
        svg.line([x + 1.0, *wanted], [x + 9.0, y], Stroke { colour, width: 1.0, dash: "" });
        let style = TextStyle { size: SMALL_PX, colour: Some(colour), bold: true, ..TextStyle::default() };
        svg.text([x + 12.0, y + 0.36 * SMALL_PX], text, style);
    }
}

/// Ascending places, moved as little as it takes to be `gap` apart and between `top` and `bottom`.
fn apart(mut places: Vec<f64>, gap: f64, top: f64, bottom: f64) -> Vec<f64> {
    for _ in 0..200 {
        for i in 1..places.len() {
            let missing = gap - (places[i] - places[i - 1]);
            if missing > 0.0 {
                places[i - 1] -= 0.5 * missing;
                places[i] += 0.5 * missing;
            }
        }
        let count = places.len();
        for (i, place) in places.iter_mut().enumerate() {
            *place =
                place.clamp(top + gap * i as f64, (bottom - gap * (count - 1 - i) as f64).max(top + gap * i as f64));
        }
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_cover_the_values() {
        let axis = Axis::around("λ", Unit::Nm, [480.0, 879.0], 8);
        assert_eq!((axis.from, axis.to), (450.0, 900.0));
        assert_eq!(axis.ticks, [450.0, 500.0, 550.0, 600.0, 650.0, 700.0, 750.0, 800.0, 850.0, 900.0]);
        let axis = Axis::around("n", Unit::Unitless, [1.2], 4);
        assert!(axis.from < 1.2 && axis.to > 1.2 && axis.ticks.len() > 1);
        let axis = Axis::around("nothing", Unit::PerSr, [f64::NAN], 4);
        assert_eq!((axis.from, axis.to), (0.0, 1.0));
    }

    #[test]
    fn tick_labels_have_one_number_of_decimals_and_a_minus_sign() {
        assert_eq!(labels(&[-0.5, 0.0, 0.25]), ["−0.50", "0.00", "0.25"]);
        assert_eq!(labels(&[-0.008, 0.0, 0.008]), ["−0.008", "0.000", "0.008"]);
        assert_eq!(labels(&[-5e-7, -0.0, 1.5e-6]), ["−5.0e−7", "0", "1.5e−6"]);
        assert_eq!(labels(&[-2e-13, 1e-29, 2e-13]), ["−2e−13", "0", "2e−13"]);
        assert_eq!(labels(&[0.0]), ["0"]);
        assert_eq!(labels(&[100.0, 200.0]), ["100", "200"]);
    }

    #[test]
    fn a_logarithmic_axis_gives_equal_room_to_equal_factors() {
        let axis = Axis::logarithmic("σ", Unit::Unitless, 0.01, 1.0);
        assert!((axis.part(0.1) - 0.5).abs() < 1e-12 && (axis.value(0.5) - 0.1).abs() < 1e-12);
        assert_eq!(axis.ticks.len(), 7);
    }

    #[test]
    fn labels_that_would_touch_are_moved_apart_within_the_frame() {
        let places = apart(vec![10.0, 11.0, 12.0, 80.0], 15.0, 0.0, 100.0);
        for pair in places.windows(2) {
            assert!(pair[1] - pair[0] > 14.9, "{places:?}");
        }
        assert!(places[0] >= 0.0 && places[3] <= 100.0);
        assert_eq!(apart(vec![10.0, 50.0], 15.0, 0.0, 100.0), [10.0, 50.0]);
    }

    #[test]
    fn scales_end_at_round_numbers() {
        for (value, round) in [(0.97, 1.0), (1.21, 1.5), (0.29, 0.3), (0.0099, 0.01), (2.0, 2.0)] {
            // a product of a digit and a power of ten: one rounding each
            assert!((round_up(value) / round - 1.0_f64).abs() < 1e-15, "{value}");
        }
    }
}

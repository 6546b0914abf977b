//! What all figures have in common: sizes, ink, and line styles that are told apart without colour.

use super::svg::Stroke;

/// Text size, px; figures are some 1000 px wide, so that half of that is still read.
pub const TEXT_PX: f64 = 15.0;
/// Small text: ticks, notes.
pub const SMALL_PX: f64 = 13.0;
/// DejaVu Sans is what PNG figures are set in; the others are near it in width.
pub const FONTS: &str = "DejaVu Sans, Verdana, Segoe UI, Roboto, Helvetica, Arial, sans-serif";
/// Text and axes.
pub const INK: &str = "#1c1f24";
/// Grid lines.
pub const FAINT: &str = "#d9dce1";
/// Behind everything.
pub const PAPER: &str = "#ffffff";

/// A series: colour, dashes and marker all differ, so that any one of them tells it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Series {
    /// Colour. From Okabe & Ito's palette (2008, jfly.uni-koeln.de/color), without its yellow, which is too pale for lines;
    /// lightness rises from the first to the last.
    pub colour: &'static str,
    /// Dash pattern, px.
    pub dash: &'static str,
    /// Shape of single values.
    pub marker: Marker,
}

/// Shape of single values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// ●
    Disc,
    /// ■
    Square,
    /// ▲
    Triangle,
    /// ◆
    Diamond,
}

/// The series in their order; more than there are begin again.
pub const SERIES: [Series; 5] = [
    Series { colour: "#0072b2", dash: "", marker: Marker::Disc },
    Series { colour: "#b34700", dash: "9 3", marker: Marker::Square },
    Series { colour: "#008060", dash: "3 3", marker: Marker::Triangle },
    Series { colour: "#a85b8b", dash: "12 3 3 3", marker: Marker::Diamond },
    Series { colour: "#56575b", dash: "6 2 2 2 2 2", marker: Marker::Disc },
];

/// The series of an index.
pub fn series(index: usize) -> Series {
    SERIES[index % SERIES.len()]
}

impl Series {
    /// Its line.
    pub fn stroke(&self, width: f64) -> Stroke<'static> {
        Stroke { colour: self.colour, width, dash: self.dash }
    }
}

/// A thin line of ink.
pub const HAIR: Stroke<'static> = Stroke { colour: INK, width: 1.0, dash: "" };
/// A grid line.
pub const GRID: Stroke<'static> = Stroke { colour: FAINT, width: 1.0, dash: "" };

//! SVG, written by hand: the few elements that figures need, numbers to a hundredth of a pixel, the same bytes every time.
//!
//! Classes (`paper`, `ink`, `faint`, `axis-label`) let a page that holds a figure recolour it for a dark screen; without such a
//! page the attributes beside them count.

use std::fmt::Write;

use super::style::{FAINT, FONTS, INK, PAPER, TEXT_PX};

/// Where a text stands against its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// The point is the middle.
    Middle,
    /// The text ends there.
    End,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke<'a> {
    /// Colour, `#rrggbb`.
    pub colour: &'a str,
    /// Width, px.
    pub width: f64,
    /// Dash pattern, px; empty for a solid line.
    pub dash: &'a str,
}

/// How a text is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextStyle<'a> {
    /// Where it stands against its point.
    pub anchor: Anchor,
    /// Size, px.
    pub size: f64,
    /// Colour; `None` is ink.
    pub colour: Option<&'a str>,
    /// Bold.
    pub bold: bool,
    /// Turned to read upwards.
    pub upwards: bool,
    /// Class beside `ink`.
    pub class: &'a str,
}

impl Default for TextStyle<'_> {
    fn default() -> Self {
        TextStyle { anchor: Anchor::Start, size: TEXT_PX, colour: None, bold: false, upwards: false, class: "" }
    }
}

impl TextStyle<'_> {
    /// A text in the middle of its point.
    pub fn middle() -> Self {
        TextStyle { anchor: Anchor::Middle, ..Self::default() }
    }

    /// A text that ends at its point.
    pub fn end() -> Self {
        TextStyle { anchor: Anchor::End, ..Self::default() }
    }
}

/// A figure in the making.
#[derive(Clone, Debug)]
pub struct Svg {
    width: f64,
    height: f64,
    title: String,
    description: String,
    /// Makes the ids of this figure differ from those of another on the same page.
    prefix: String,
    clips: usize,
    body: String,
}

impl Svg {
    /// A figure of a size in px. `prefix` goes into its ids: letters, digits and `-`.
    pub fn new(width: f64, height: f64, prefix: &str, title: &str, description: &str) -> Self {
        let kept = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        Svg {
            width,
            height,
            title: title.to_string(),
            description: description.to_string(),
            prefix: prefix.chars().map(kept).collect(),
            clips: 0,
            body: String::new(),
        }
    }

    /// The whole document.
    pub fn finish(self) -> String {
        let (w, h) = (number(self.width), number(self.height));
        let (title, description) = (escaped(&plain(&self.title)), escaped(&plain(&self.description)));
        let id = &self.prefix;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" role=\"img\" \
             aria-labelledby=\"{id}-title {id}-desc\" font-family=\"{FONTS}\" font-size=\"{TEXT_PX}\">\n\
             <title id=\"{id}-title\">{title}</title>\n<desc id=\"{id}-desc\">{description}</desc>\n\
             <rect class=\"paper\" width=\"{w}\" height=\"{h}\" fill=\"{PAPER}\"/>\n{}</svg>\n",
            self.body
        )
    }

    /// A straight line.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke<'_>) {
        let [x1, y1, x2, y2] = [from[0], from[1], to[0], to[1]].map(number);
        let _ = writeln!(self.body, "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"{}/>", stroke.attributes());
    }

    /// A line through points; a point that is no number interrupts it.
    pub fn polyline(&mut self, points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke<'_>) {
        let mut data = String::new();
        let mut pen_down = false;
        for [x, y] in points {
            if x.is_finite() && y.is_finite() {
                let _ = write!(data, "{}{} {}", if pen_down { "L" } else { "M" }, number(x), number(y));
                pen_down = true;
            } else {
                pen_down = false;
            }
        }
        if !data.is_empty() {
            let attributes = stroke.attributes();
            let _ = writeln!(self.body, "<path d=\"{data}\" fill=\"none\" stroke-linejoin=\"round\"{attributes}/>");
        }
    }

    /// A filled shape, by its path.
    pub fn fill(&mut self, data: &str, colour: &str, opacity: f64) {
        if data.is_empty() {
            return;
        }
        let opacity = if opacity < 1.0 { format!(" fill-opacity=\"{}\"", number(opacity)) } else { String::new() };
        let _ = writeln!(self.body, "<path d=\"{data}\" fill=\"{colour}\"{opacity} fill-rule=\"evenodd\"/>");
    }

    /// The outline of a shape, by its path.
    pub fn outline(&mut self, data: &str, stroke: Stroke<'_>) {
        if !data.is_empty() {
            let _ = writeln!(self.body, "<path d=\"{data}\" fill=\"none\"{}/>", stroke.attributes());
        }
    }

    /// A rectangle.
    pub fn rect(&mut self, [x, y, width, height]: [f64; 4], fill: &str, class: &str) {
        let [x, y, width, height] = [x, y, width, height].map(number);
        let _ = writeln!(
            self.body,
            "<rect{} x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\"/>",
            class_attribute(class)
        );
    }

    /// A circle; `stroke` and `fill` are attributes of their own.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, fill: &str, stroke: Option<Stroke<'_>>, class: &str) {
        let stroke = stroke.map_or_else(String::new, Stroke::attributes);
        let [x, y, r] = [x, y, radius].map(number);
        let _ = writeln!(
            self.body,
            "<circle{} cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{fill}\"{stroke}/>",
            class_attribute(class)
        );
    }

    /// A text. `_x`, `_{xyz}` are subscripts, `^x`, `^{xyz}` superscripts.
    pub fn text(&mut self, [x, y]: [f64; 2], text: &str, style: TextStyle<'_>) {
        let anchor = match style.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let ink = if style.colour.is_none() { "ink " } else { "" };
        let class = class_attribute(format!("{ink}{}", style.class).trim());
        let size = if style.size == TEXT_PX { String::new() } else { format!(" font-size=\"{}\"", number(style.size)) };
        let bold = if style.bold { " font-weight=\"bold\"" } else { "" };
        let [x, y] = [x, y].map(number);
        let turned = if style.upwards { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
        let colour = style.colour.unwrap_or(INK);
        let spans = spans(text, style.size);
        let _ = writeln!(
            self.body,
            "<text{class} x=\"{x}\" y=\"{y}\"{anchor}{size}{bold}{turned} fill=\"{colour}\">{spans}</text>"
        );
    }

    /// A group that shows only what lies inside a path; end it with [`Svg::end`].
    pub fn begin_clip(&mut self, data: &str) {
        self.clips += 1;
        let id = format!("{}-clip{}", self.prefix, self.clips);
        let _ =
            writeln!(self.body, "<clipPath id=\"{id}\"><path d=\"{data}\"/></clipPath>\n<g clip-path=\"url(#{id})\">");
    }

    /// A group under a class; end it with [`Svg::end`].
    pub fn begin(&mut self, class: &str) {
        let _ = writeln!(self.body, "<g{}>", class_attribute(class));
    }

    /// A group whose zero is a point; end it with [`Svg::end`].
    pub fn begin_at(&mut self, [x, y]: [f64; 2]) {
        let _ = writeln!(self.body, "<g transform=\"translate({} {})\">", number(x), number(y));
    }

    /// Ends a group.
    pub fn end(&mut self) {
        self.body.push_str("</g>\n");
    }
}

impl Stroke<'_> {
    fn attributes(self) -> String {
        let dash = if self.dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", self.dash) };
        let class = match self.colour {
            INK => " class=\"ink-line\"",
            FAINT => " class=\"faint\"",
            _ => "",
        };
        format!("{class} stroke=\"{}\" stroke-width=\"{}\"{dash}", self.colour, number(self.width))
    }
}

fn class_attribute(class: &str) -> String {
    if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") }
}

/// A coordinate to a hundredth of a pixel, in as few letters as that takes.
pub fn number(value: f64) -> String {
    let rounded = (value * 100.0).round() / 100.0;
    // +0: the sign of a negative zero is not worth a letter
    format!("{}", rounded + 0.0)
}

/// `&`, `<`, `>` and quotes as XML wants them; characters that XML forbids become U+FFFD.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            c if c.is_control() => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

/// One piece of a text: on the line (0), below (−1) or above it (1).
fn pieces(text: &str) -> Vec<(i8, String)> {
    let mut pieces: Vec<(i8, String)> = vec![(0, String::new())];
    let mut letters = text.chars().peekable();
    while let Some(letter) = letters.next() {
        let level = match letter {
            '\\' => {
                let plain = letters.next().unwrap_or('\\');
                push(&mut pieces, 0, plain);
                continue;
            }
            '_' => -1,
            '^' => 1,
            other => {
                push(&mut pieces, 0, other);
                continue;
            }
        };
        if letters.peek() == Some(&'{') {
            letters.next();
            for inner in letters.by_ref().take_while(|c| *c != '}') {
                push(&mut pieces, level, inner);
            }
        } else if let Some(one) = letters.next() {
            push(&mut pieces, level, one);
        }
    }
    pieces
}

fn push(pieces: &mut Vec<(i8, String)>, level: i8, letter: char) {
    match pieces.last_mut() {
        Some((last, text)) if *last == level => text.push(letter),
        _ => pieces.push((level, letter.to_string())),
    }
}

/// A text without its marks, for titles.
pub fn plain(text: &str) -> String {
    pieces(text).into_iter().map(|(_, piece)| piece).collect()
}

/// The same as HTML: `<sub>` and `<sup>`.
pub fn html(text: &str) -> String {
    let piece = |(level, piece): (i8, String)| match level {
        0 => escaped(&piece),
        below if below < 0 => format!("<sub>{}</sub>", escaped(&piece)),
        _ => format!("<sup>{}</sup>", escaped(&piece)),
    };
    pieces(text).into_iter().map(piece).collect()
}

/// A name of the user's, in which `_` and `^` are letters.
pub fn literal(name: &str) -> String {
    name.replace('\\', "\\\\").replace('_', "\\_").replace('^', "\\^")
}

/// The same as tspans: lowered and raised by `dy`, which every renderer knows.
fn spans(text: &str, size: f64) -> String {
    let mut spans = String::new();
    let mut height = 0.0;
    for (level, piece) in pieces(text) {
        if piece.is_empty() {
            continue;
        }
        let wanted = match level {
            0 => 0.0,
            below if below < 0 => 0.22 * size,
            _ => -0.36 * size,
        };
        let (dy, small) = (wanted - height, if level == 0 { size } else { 0.72 * size });
        height = wanted;
        if dy == 0.0 && level == 0 {
            spans.push_str(&escaped(&piece));
        } else {
            let _ = write!(
                spans,
                "<tspan dy=\"{}\" font-size=\"{}\">{}</tspan>",
                number(dy),
                number(small),
                escaped(&piece)
            );
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscripts_go_down_and_the_line_comes_back_up() {
        assert_eq!(pieces("θ_s = 8"), [(0, "θ".into()), (-1, "s".into()), (0, " = 8".into())]);
        assert_eq!(plain("k_{L} sr^{−1}"), "kL sr−1");
        let spans = spans("θ_s x", 10.0);
        assert_eq!(
            spans,
            "θ<tspan dy=\"2.2\" font-size=\"7.2\">s</tspan><tspan dy=\"-2.2\" font-size=\"10\"> x</tspan>"
        );
    }

    #[test]
    fn names_of_leaves_keep_their_underscores_and_cannot_break_the_markup() {
        assert_eq!(plain(&literal("leaf_3^a\\b")), "leaf_3^a\\b");
        assert_eq!(escaped("<a href=\"x\">&\u{1}"), "&lt;a href=&quot;x&quot;&gt;&amp;\u{fffd}");
    }

    #[test]
    fn coordinates_are_short() {
        assert_eq!([1.0, 1.239, -0.001, 1.5].map(number), ["1", "1.24", "0", "1.5"]);
    }
}

//! One self-contained HTML page: text, tables and figures, no network, no script; light or dark as the reader's screen is, and
//! readable on a telephone.
//!
//! | room | what |
//! |---|---|
//! | this one | the page: sections, tables, figures |
//! | `study` | the demo's study as such a page |
//! | `page.css` | how it looks |

mod study;

pub use study::of_study;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use crate::demo::{FIT, FIT_TWO_STEP, Study};
use crate::output::AtomicFile;
use crate::plot::text::{escaped, html, plain};
use crate::plot::{self, Figure, Kind, PlotError, PlotOptions};

/// A page.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// What it is about, in a few sentences.
    pub lead: Vec<String>,
    /// Its parts.
    pub sections: Vec<Section>,
}

/// A part of a page.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Its heading; in text, `_x` and `^x` are sub- and superscripts.
    pub heading: String,
    /// What it holds.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A table.
    Table(Table),
    /// A figure.
    Figure(Figure),
}

/// A table.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// What it shows.
    pub caption: String,
    /// Names of the columns, with units.
    pub columns: Vec<String>,
    /// One cell a column; the first names the row.
    pub rows: Vec<Vec<String>>,
    /// What to know before using the numbers.
    pub note: String,
    /// Its cells are sentences rather than numbers.
    pub prose: bool,
}

impl Page {
    /// The document.
    pub fn html(&self) -> String {
        let mut body = String::new();
        let _ = writeln!(body, "<header>\n<h1>{}</h1>", html(&self.title));
        for sentence in &self.lead {
            let _ = writeln!(body, "<p>{}</p>", html(sentence));
        }
        body.push_str("<nav aria-label=\"Contents\"><ol>\n");
        for (place, section) in self.sections.iter().enumerate() {
            let _ = writeln!(body, "<li><a href=\"#s{}\">{}</a></li>", place + 1, html(&section.heading));
        }
        body.push_str("</ol></nav>\n</header>\n<main>\n");
        let mut figures = 0;
        for (place, section) in self.sections.iter().enumerate() {
            let _ = writeln!(body, "<section id=\"s{}\">\n<h2>{}</h2>", place + 1, html(&section.heading));
            for block in &section.blocks {
                match block {
                    Block::Text(text) => {
                        let _ = writeln!(body, "<p>{}</p>", html(text));
                    }
                    Block::Table(table) => table.html(&mut body),
                    Block::Figure(figure) => {
                        figures += 1;
                        let svg = with_ids_of_its_own(&figure.svg, figures);
                        let caption = html(&figure.caption);
                        let _ = writeln!(
                            body,
                            "<figure>\n<div class=\"wide\" tabindex=\"0\">\n{svg}</div>\n<figcaption><b>Figure {figures}.</b> \
                             {caption}</figcaption>\n</figure>"
                        );
                    }
                }
            }
            body.push_str("</section>\n");
        }
        body.push_str("</main>\n");
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <meta name=\"color-scheme\" content=\"light dark\"/>\n\
             <title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n{body}<footer><p>Made by leafbrdf {}.</p></footer>\n\
             </body>\n</html>\n",
            escaped(&plain(&self.title)),
            include_str!("report/page.css"),
            env!("CARGO_PKG_VERSION")
        )
    }
}

/// Name of the page in the demo's folder.
pub const FILE: &str = "report.html";

/// Draws the figures of a demo's fits beside them (SVG), and writes `report.html` into its folder, whole or not at all.
///
/// # Errors
/// Fits that are not what the demo wrote, and the system's.
pub fn write(folder: &Path, study: &Study) -> Result<PathBuf, PlotError> {
    let options = PlotOptions { kinds: vec![Kind::Svg], ..PlotOptions::default() };
    let bands = folder.join(FIT);
    let mut drawn = plot::draw(&bands, &options)?;
    drawn.write(&bands, &options.kinds)?;
    // Fig. 7 is a figure of the whole leaf
    let five = folder.join(FIT_TWO_STEP);
    let zenith = plot::draw(&five, &PlotOptions { only: vec!["dhrf-zenith"], ..options.clone() })?;
    zenith.write(&five, &options.kinds)?;
    for (leaf, figures) in zenith.leaves {
        if let Some((_, others)) = drawn.leaves.iter_mut().find(|(other, _)| *other == leaf) {
            others.extend(figures);
        }
    }
    // in the paper's order
    let place = |name: &str| study.leaves.iter().position(|leaf| leaf.name == name);
    drawn.leaves.sort_by_key(|(name, _)| place(name));
    let path = folder.join(FILE);
    let page = of_study(study, &drawn).html();
    let written = AtomicFile::create(&path).and_then(|mut file| {
        file.write_all(page.as_bytes())?;
        file.commit()
    });
    written.map_err(|error| PlotError(format!("{}: cannot be written: {error}", path.display())))?;
    Ok(path)
}

impl Table {
    fn html(&self, body: &mut String) {
        let _ = writeln!(
            body,
            "<div class=\"wide\" tabindex=\"0\">\n<table{}>\n<caption>{}</caption>",
            if self.prose { " class=\"prose\"" } else { "" },
            html(&self.caption)
        );
        body.push_str("<thead><tr>");
        for column in &self.columns {
            let _ = write!(body, "<th scope=\"col\">{}</th>", html(column));
        }
        body.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            body.push_str("<tr>");
            for (place, cell) in row.iter().enumerate() {
                let _ = match place {
                    0 => write!(body, "<th scope=\"row\">{}</th>", html(cell)),
                    _ => write!(body, "<td>{}</td>", html(cell)),
                };
            }
            body.push_str("</tr>\n");
        }
        body.push_str("</tbody>\n</table>\n</div>\n");
        if !self.note.is_empty() {
            let _ = writeln!(body, "<p class=\"note\">{}</p>", html(&self.note));
        }
    }
}

/// A figure whose ids do not meet those of another on the page.
fn with_ids_of_its_own(svg: &str, number: usize) -> String {
    let svg = svg.replace(" id=\"", &format!(" id=\"f{number}-")).replace("url(#", &format!("url(#f{number}-"));
    match svg.split_once(" aria-labelledby=\"").and_then(|(before, rest)| Some((before, rest.split_once('"')?))) {
        Some((before, (ids, after))) => {
            let ids: Vec<String> = ids.split(' ').map(|id| format!("f{number}-{id}")).collect();
            format!("{before} aria-labelledby=\"{}\"{after}", ids.join(" "))
        }
        None => svg,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> Page {
        let figure = || {
            let mut svg = plot::text::blank("one", "A & B");
            svg.insert_str(
                svg.rfind("</svg>").unwrap(),
                "<clipPath id=\"one-clip1\"/><g clip-path=\"url(#one-clip1)\"/>",
            );
            Block::Figure(Figure { name: "one", caption: "k_L over λ".into(), svg })
        };
        let table = Table {
            caption: "Table".into(),
            columns: vec!["leaf".into(), "n (unitless)".into()],
            rows: vec![vec!["<beech>".into(), "1.56 ± 0.01".into()]],
            note: "a note".into(),
            prose: false,
        };
        Page {
            title: "A study & more".into(),
            lead: vec!["In short.".into()],
            sections: vec![Section { heading: "One".into(), blocks: vec![figure(), Block::Table(table), figure()] }],
        }
    }

    #[test]
    fn the_page_is_well_formed_and_every_id_stands_once() {
        let html = page().html();
        // XML's rules are stricter than HTML's: what passes here every browser reads the same way
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
        let document = roxmltree::Document::parse_with_options(&html, options).unwrap();
        let mut ids: Vec<&str> = document.descendants().filter_map(|node| node.attribute("id")).collect();
        let count = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!((ids.len(), count), (7, 7), "{ids:?}");
        for node in document.descendants() {
            for id in node.attribute("aria-labelledby").into_iter().flat_map(|names| names.split(' ')) {
                assert!(ids.contains(&id), "{id}");
            }
            if let Some(clip) = node.attribute("clip-path") {
                assert!(ids.contains(&clip.trim_start_matches("url(#").trim_end_matches(')')), "{clip}");
            }
        }
    }

    #[test]
    fn the_page_asks_nothing_of_a_network() {
        let html = page().html();
        let without_names = html.replace("http://www.w3.org/2000/svg", "");
        for word in ["http:", "https:", "<script", "<link", "@import", "src="] {
            assert!(!without_names.contains(word), "{word}");
        }
        assert!(html.contains("&lt;beech&gt;") && html.contains("k<sub>L</sub>"));
    }
}

//! The report as one HTML page that needs nothing else.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::picture::Picture;

/// A part of the report with a heading.
#[derive(Clone, Debug)]
pub struct Section {
    /// Short name, for links and for the names of picture files.
    pub id: &'static str,
    pub title: String,
    pub body: Markup,
    /// All pictures of the body, with the names of their files.
    pub pictures: Vec<(String, Picture)>,
}

/// Rows of so many pictures, fewer where the page is narrow.
pub struct Tiles {
    section: &'static str,
    columns: usize,
    body: Vec<Markup>,
    pictures: Vec<(String, Picture)>,
}

impl Tiles {
    pub fn new(section: &'static str, columns: usize) -> Tiles {
        Tiles { section, columns, body: Vec::new(), pictures: Vec::new() }
    }

    /// Appends a picture; `name` tells it apart from the others of the section.
    pub fn push(&mut self, name: &str, picture: Picture, caption: &str) {
        let name = format!("{}-{name}", self.section);
        let data = format!("data:image/png;base64,{}", STANDARD.encode(&picture.png));
        self.body.push(html! {
            figure {
                img src=(data) alt=(caption) width=(picture.width) height=(picture.height);
                figcaption { (caption) }
            }
        });
        self.pictures.push((name, picture));
    }

    /// The rows, and the pictures for their files.
    pub fn finish(self) -> (Markup, Vec<(String, Picture)>) {
        let columns = format!("--columns: {}", self.columns);
        (html! { div.tiles style=(columns) { @for tile in &self.body { (tile) } } }, self.pictures)
    }
}

/// A table that scrolls in itself where the page is narrow.
pub fn table(head: &[impl AsRef<str>], rows: &[Vec<String>]) -> Markup {
    html! {
        div.wide { table {
            thead { tr { @for name in head { th scope="col" { (name.as_ref()) } } } }
            tbody { @for row in rows { tr {
                @for (i, cell) in row.iter().enumerate() {
                    @if i == 0 { th scope="row" { (cell) } } @else { td { (cell) } }
                }
            } } }
        } }
    }
}

/// The whole page.
pub fn page(title: &str, introduction: &Markup, sections: &[Section]) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body {
                header { h1 { (title) } (introduction) }
                nav aria-label="Sections" { ol {
                    @for section in sections { li { a href={ "#" (section.id) } { (section.title) } } }
                } }
                main { @for section in sections {
                    section id=(section.id) { h2 { (section.title) } (section.body) }
                } }
            }
        }
    };
    page.into_string()
}

const STYLE: &str = "
:root { color-scheme: light dark; --ink: #1c2127; --paper: #fbfaf7; --rule: #d4d1c9; --soft: #5b6570; --link: #0a5ca8; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e5e2db; --paper: #15181c; --rule: #3a4048; --soft: #a3abb4; --link: #7db8f0; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 76rem; padding: 1rem clamp(0.8rem, 3vw, 2.5rem) 4rem;
  background: var(--paper); color: var(--ink); font: 1rem/1.55 system-ui, sans-serif; }
h1 { font-size: clamp(1.5rem, 4vw, 2.2rem); line-height: 1.2; margin: 1rem 0 0.5rem; }
h2 { font-size: 1.3rem; line-height: 1.3; margin: 0 0 0.5rem; }
h3 { font-size: 1.05rem; margin: 1.4rem 0 0.3rem; }
p, li, figcaption { max-width: 46rem; overflow-wrap: break-word; }
a { color: var(--link); }
code { font-size: 0.92em; }
nav ol { columns: 22rem; padding-left: 1.6rem; }
section { border-top: 1px solid var(--rule); margin-top: 2.5rem; padding-top: 1.2rem; }
figure { margin: 0; }
.tiles { display: grid; gap: 1rem; margin: 1rem 0; grid-template-columns: repeat(var(--columns), 1fr); }
@media (max-width: 60rem) { .tiles { grid-template-columns: repeat(2, 1fr); } }
@media (max-width: 34rem) { .tiles { grid-template-columns: 1fr; } }
.tiles img { display: block; width: 100%; height: auto; border: 1px solid var(--rule); }
figcaption { color: var(--soft); font-size: 0.88rem; line-height: 1.4; margin-top: 0.3rem; }
.plot { max-width: 44rem; margin: 1rem 0; }
.plot svg { display: block; width: 100%; height: auto; }
.legend { list-style: none; margin: 0.2rem 0 0 2.5rem; padding: 0; display: flex; flex-wrap: wrap; gap: 0.1rem 1.2rem; font-size: 0.85rem; }
.legend span { font-size: 1.3em; font-weight: 700; line-height: 1; }
.plots { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(min(100%, 28rem), 1fr)); }
details summary { cursor: pointer; color: var(--link); }
.wide { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-size: 0.9rem; font-variant-numeric: tabular-nums; }
th, td { padding: 0.25rem 0.7rem; border-bottom: 1px solid var(--rule); text-align: right; white-space: nowrap; }
th[scope=row], thead th:first-child { text-align: left; font-weight: 500; }
thead th { color: var(--soft); font-weight: 600; }
";

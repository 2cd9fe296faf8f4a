//! Line plots as SVG, by the library `kuva`. Nothing else in this crate knows it.

use std::sync::Arc;

use kuva::plot::scatter::MarkerShape;
use kuva::prelude::{Layout, LinePlot, Plot, ScatterPlot, Theme, TickFormat, render_to_svg};
use maud::{Markup, PreEscaped, html};

/// Colours that the colour-blind tell apart (Wong, Nature Methods 2011), without the yellow that is
/// lost on white and the black that is lost in the dark; and a marker for each.
const LOOKS: [(&str, MarkerShape, &str); 6] = [
    ("#0077BB", MarkerShape::Circle, "●"),
    ("#E69F00", MarkerShape::Square, "■"),
    ("#009E73", MarkerShape::Triangle, "▲"),
    ("#CC79A7", MarkerShape::Diamond, "◆"),
    ("#D55E00", MarkerShape::Cross, "✕"),
    ("#56B4E9", MarkerShape::TriangleDown, "▼"),
];

const GRAY: &str = "#8a8a8a";

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// A line.
    Line,
    /// A dashed line.
    Dashed,
    /// A line with a marker at every point.
    Marked,
    /// A thick grey line, for what the others are compared with.
    Truth,
}

/// A named curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// As the legend calls it.
    pub name: String,
    /// In the order in which they are joined; the line is broken where one is NaN.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub stroke: Stroke,
}

impl Curve {
    pub fn new(name: impl Into<String>, stroke: Stroke, points: Vec<(f64, f64)>) -> Curve {
        Curve { name: name.into(), points, stroke }
    }
}

/// How the axes of a plot are divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Both evenly; y between the two values.
    Linear([f64; 2]),
    /// x evenly, y by powers.
    LogarithmicY,
    /// Both by powers.
    Logarithmic,
}

/// What the axes say.
#[derive(Clone, Copy, Debug)]
pub struct Axes<'a> {
    /// Quantity and unit along x.
    pub x: &'a str,
    /// Quantity and unit along y.
    pub y: &'a str,
    pub scale: Scale,
}

/// The plot and its legend, in the colours of the page.
pub fn plot(axes: Axes<'_>, curves: &[Curve]) -> Markup {
    let mut plots: Vec<Plot> = Vec::new();
    let mut legend = Vec::new();
    let mut looks = LOOKS.into_iter().cycle();
    for curve in curves {
        let (color, marker, glyph) = match curve.stroke {
            Stroke::Truth => (GRAY, MarkerShape::Circle, ""),
            _ => looks.next().expect("the looks never end"),
        };
        let sign = match curve.stroke {
            Stroke::Truth => "━",
            Stroke::Line => "—",
            Stroke::Dashed => "╌",
            Stroke::Marked => glyph,
        };
        for points in curve.points.split(|(x, y)| x.is_nan() || y.is_nan()) {
            if points.is_empty() {
                continue;
            }
            let line = LinePlot::new().with_data(points.iter().copied()).with_color(color);
            let line = match curve.stroke {
                Stroke::Truth => line.with_stroke_width(5.0),
                Stroke::Line => line.with_stroke_width(2.0),
                Stroke::Dashed => line.with_stroke_width(2.0).with_dashed(),
                Stroke::Marked => line.with_stroke_width(1.5),
            };
            plots.push(line.into());
            if curve.stroke == Stroke::Marked {
                let dots = ScatterPlot::new().with_data(points.iter().copied());
                let dots = dots.with_color(color).with_size(4.0).with_marker(marker);
                plots.push(dots.into());
            }
        }
        legend.push((color, sign, &curve.name));
    }
    let page = |name: &str| format!("var(--{name})");
    let theme = Theme {
        background: "none".into(),
        axis_color: page("ink"),
        grid_color: page("rule"),
        tick_color: page("ink"),
        text_color: page("ink"),
        font_family: Some("inherit".into()),
        ..Theme::light()
    };
    let layout = Layout::auto_from_plots(&plots)
        .with_x_label(axes.x)
        .with_y_label(axes.y)
        .with_width(500.0)
        .with_height(340.0)
        .with_theme(theme);
    let plain = TickFormat::Custom(Arc::new(plain));
    let layout = match axes.scale {
        Scale::Linear([low, high]) => layout.with_y_axis_min(low).with_y_axis_max(high),
        Scale::LogarithmicY => layout.with_log_y().with_tick_format(plain),
        Scale::Logarithmic => layout.with_log_scale().with_tick_format(plain),
    };
    html! {
        figure.plot {
            (PreEscaped(scalable(&render_to_svg(plots, layout))))
            ul.legend { @for (color, sign, name) in legend {
                li { span style={ "color:" (color) } aria-hidden="true" { (sign) } " " (name) }
            } }
        }
    }
}

/// A number without an exponent and without idle zeros.
fn plain(value: f64) -> String {
    format!("{value:.5}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The same picture with a `viewBox` in the place of its fixed size.
fn scalable(svg: &str) -> String {
    let attribute = |name: &str| {
        let start = svg.find(&format!(" {name}=\""))? + name.len() + 3;
        Some(&svg[start..start + svg[start..].find('"')?])
    };
    let (Some(width), Some(height)) = (attribute("width"), attribute("height")) else {
        return svg.to_owned();
    };
    let old = format!(" width=\"{width}\" height=\"{height}\"");
    svg.replacen(&old, &format!(" role=\"img\" viewBox=\"0 0 {width} {height}\""), 1)
}

//! Line plots as SVG, by the library `kuva`. Nothing else in this crate knows it.

use std::sync::Arc;

use kuva::plot::line::LineStyle;
use kuva::plot::scatter::MarkerShape;
use kuva::prelude::{Layout, LinePlot, Plot, ScatterPlot, Theme, TickFormat, render_to_svg};
use maud::{Markup, PreEscaped, html};

/// Colours that the colour-blind tell apart (Wong, Nature Methods 2011; the last by Tol), without
/// the yellow that is lost on white and the black that is lost in the dark; and a marker for each.
const LOOKS: [(&str, MarkerShape, &str); 7] = [
    ("#0077BB", MarkerShape::Circle, "●"),
    ("#E69F00", MarkerShape::Square, "■"),
    ("#009E73", MarkerShape::Triangle, "▲"),
    ("#CC79A7", MarkerShape::Diamond, "◆"),
    ("#D55E00", MarkerShape::Cross, "✕"),
    ("#56B4E9", MarkerShape::TriangleDown, "▼"),
    ("#AA4499", MarkerShape::Plus, "+"),
];

/// The lines of the first, second and third curve of a family, and their signs in the legend.
const LINES: [(LineStyle, &str); 3] =
    [(LineStyle::Solid, ""), (LineStyle::Dashed, "╌"), (LineStyle::Dotted, "┈")];

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
    /// Curves of one family share colour and marker, and differ in their lines.
    pub family: String,
    /// In the order in which they are joined; the line is broken where one is NaN.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub stroke: Stroke,
}

impl Curve {
    /// A curve with a look of its own.
    pub fn new(name: impl Into<String>, stroke: Stroke, points: Vec<(f64, f64)>) -> Curve {
        let name = name.into();
        Curve { family: name.clone(), name, points, stroke }
    }
}

/// How the axes of a plot are divided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Both evenly; y between the two values.
    Linear([f64; 2]),
    /// x evenly, y by powers of ten.
    LogarithmicY,
    /// Both by powers of ten.
    Logarithmic,
    /// x by powers of two, y by powers of ten.
    Doubling,
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
    for (curve, look) in curves.iter().zip(looks(curves)) {
        for points in curve.points.split(|(x, y)| x.is_nan() || y.is_nan()) {
            if !points.is_empty() {
                draw(&mut plots, curve.stroke, &look, axes.scale, points);
            }
        }
        legend.push((look, &curve.name));
    }
    let layout = layout(axes, &plots, curves);
    html! {
        figure.plot {
            (PreEscaped(scalable(&render_to_svg(plots, layout))))
            ul.legend { @for (look, name) in legend {
                li { span style={ "color:" (look.color) } aria-hidden="true" { (look.sign) } " " (name) }
            } }
        }
    }
}

/// What tells a curve from the others.
struct Look {
    color: &'static str,
    marker: MarkerShape,
    line: LineStyle,
    sign: String,
}

/// One per curve.
fn looks(curves: &[Curve]) -> Vec<Look> {
    let mut families: Vec<(&str, usize)> = Vec::new();
    let mut looks = Vec::new();
    for curve in curves {
        if curve.stroke == Stroke::Truth {
            let (marker, line) = (MarkerShape::Circle, LineStyle::Solid);
            looks.push(Look { color: GRAY, marker, line, sign: "━".to_owned() });
            continue;
        }
        let known = families.iter().position(|(name, _)| *name == curve.family);
        let family = known.unwrap_or_else(|| {
            families.push((&curve.family, 0));
            families.len() - 1
        });
        let (color, marker, glyph) = LOOKS[family % LOOKS.len()];
        let members = &mut families[family].1;
        let (line, dashes) = LINES[*members % LINES.len()].clone();
        *members += 1;
        let (line, sign) = match curve.stroke {
            Stroke::Line => (line, "—".to_owned()),
            Stroke::Dashed => (LineStyle::Dashed, "╌".to_owned()),
            _ => (line, format!("{glyph}{dashes}")),
        };
        looks.push(Look { color, marker, line, sign });
    }
    looks
}

/// Draws one piece of a curve.
fn draw(plots: &mut Vec<Plot>, stroke: Stroke, look: &Look, scale: Scale, points: &[(f64, f64)]) {
    let place = |&(x, y): &(f64, f64)| (if scale == Scale::Doubling { x.log2() } else { x }, y);
    let width = match stroke {
        Stroke::Truth => 5.0,
        Stroke::Line | Stroke::Dashed => 2.0,
        Stroke::Marked => 1.5,
    };
    let line = LinePlot::new().with_data(points.iter().map(place)).with_color(look.color);
    plots.push(line.with_stroke_width(width).with_line_style(look.line.clone()).into());
    if stroke == Stroke::Marked {
        let dots = ScatterPlot::new().with_data(points.iter().map(place));
        plots.push(dots.with_color(look.color).with_size(4.0).with_marker(look.marker).into());
    }
}

fn layout(axes: Axes<'_>, plots: &[Plot], curves: &[Curve]) -> Layout {
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
    let layout = Layout::auto_from_plots(plots)
        .with_x_label(axes.x)
        .with_y_label(axes.y)
        .with_width(500.0)
        .with_height(340.0)
        .with_theme(theme);
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let [low_x, high_x] = around(points().map(|(x, _)| *x));
    let [low_y, high_y] = around(points().map(|(_, y)| *y));
    let by_powers_y = |layout: Layout| {
        let layout = layout.with_log_y().with_y_axis_min(low_y).with_y_axis_max(high_y);
        layout.with_tick_format(TickFormat::Custom(Arc::new(plain)))
    };
    match axes.scale {
        Scale::Linear([low, high]) => layout.with_y_axis_min(low).with_y_axis_max(high),
        Scale::LogarithmicY => by_powers_y(layout),
        Scale::Logarithmic => {
            by_powers_y(layout.with_log_x().with_x_axis_min(low_x).with_x_axis_max(high_x))
        }
        Scale::Doubling => {
            let exponents = || points().map(|(x, _)| x.log2());
            let low = exponents().fold(f64::INFINITY, f64::min);
            let high = exponents().fold(f64::NEG_INFINITY, f64::max);
            let step = ((high - low) / MOST_TICKS).ceil().max(1.0);
            let layout = layout.with_x_axis_min(low - MARGIN).with_x_axis_max(high + MARGIN);
            let layout = layout.with_x_tick_step(step);
            let power = if high > LONGEST { superscript } else { |x: f64| plain(x.exp2()) };
            by_powers_y(layout).with_x_tick_format(TickFormat::Custom(Arc::new(power)))
        }
    }
}

/// What is left free on both sides of powers of two.
const MARGIN: f64 = 0.25;

/// So many ticks have room along x.
const MOST_TICKS: f64 = 8.0;

/// Powers of two beyond this one are written as powers.
const LONGEST: f64 = 14.0;

/// The next of 1, 2, 5, 10, 20, ... on both sides of positive values.
fn around(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) = values
        .filter(|value| *value > 0.0)
        .fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    if low > high {
        return [1.0, 10.0];
    }
    let steps = |value: f64| {
        let decade = 10_f64.powf(value.log10().floor());
        [1.0, 2.0, 5.0, 10.0].map(|step| step * decade)
    };
    let below = steps(low).into_iter().rev().find(|step| *step <= low).unwrap_or(low);
    let above = steps(high).into_iter().find(|step| *step > high).unwrap_or(high);
    [below, above]
}

/// A number without an exponent and without idle zeros.
fn plain(value: f64) -> String {
    format!("{value:.5}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Two to a whole power.
fn superscript(power: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let digits = format!("{power:.0}");
    let raised =
        digits.bytes().filter_map(|digit| DIGITS.get(usize::from(digit.wrapping_sub(b'0'))));
    format!("2{}", raised.collect::<String>())
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

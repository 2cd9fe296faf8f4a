//! The values of options, from text.

use glam::Vec3;
use shadowmap_core::Light;

use crate::Error;

/// The largest width and height of pictures and of light maps: what the rasterizer can draw.
pub const MAX_SIZE: u32 = raster::MAX_SIZE;

/// `WxH`, each from 1 to [`MAX_SIZE`].
///
/// # Errors
///
/// If `text` is anything else.
pub fn size(option: &str, text: &str) -> Result<[u32; 2], Error> {
    let wrong = || {
        let text =
            format_args!("{option} {text}: expected WIDTHxHEIGHT, each from 1 to {MAX_SIZE}");
        Error::new(text)
    };
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |text: &str| {
        text.parse().ok().filter(|side| (1..=MAX_SIZE).contains(side)).ok_or_else(wrong)
    };
    Ok([side(width)?, side(height)?])
}

/// A whole number from `range`.
///
/// # Errors
///
/// If `text` is anything else.
pub fn count(option: &str, text: &str, range: std::ops::RangeInclusive<u32>) -> Result<u32, Error> {
    text.parse().ok().filter(|value| range.contains(value)).ok_or_else(|| {
        let (low, high) = (range.start(), range.end());
        Error::new(format_args!("{option} {text}: expected a whole number from {low} to {high}"))
    })
}

/// A finite number for which `allowed` holds; `expected` says which those are.
///
/// # Errors
///
/// If `text` is anything else.
pub fn number(
    option: &str,
    text: &str,
    expected: &str,
    allowed: impl Fn(f32) -> bool,
) -> Result<f32, Error> {
    finite(text)
        .filter(|&value| allowed(value))
        .ok_or_else(|| Error::new(format_args!("{option} {text}: expected {expected}")))
}

/// A field of view in degrees, returned in radians.
///
/// # Errors
///
/// If `text` is not a number between 0 and 180.
pub fn field_of_view(option: &str, text: &str) -> Result<f32, Error> {
    let allowed = |degrees| (0.01..=179.0).contains(&degrees);
    Ok(number(option, text, "degrees from 0.01 to 179", allowed)?.to_radians())
}

/// `x,y,z` in metres.
///
/// # Errors
///
/// If `text` is anything else, or farther from the origin than 1e6 m along an axis.
pub fn point(option: &str, text: &str) -> Result<Vec3, Error> {
    vector(text).ok_or_else(|| {
        Error::new(format_args!(
            "{option} {text}: expected x,y,z: three numbers from -1e6 to 1e6 with commas between"
        ))
    })
}

/// A light: `point:x,y,z`, `sphere:x,y,z:R`, `sun:dx,dy,dz:DEG`, `linear:x,y,z:x,y,z`,
/// `triangle:a:b:c`, `rect:corner:edge:edge`.
///
/// # Errors
///
/// If `text` is none of these, or the light has no extent that its kind needs.
pub fn light(text: &str) -> Result<Light, Error> {
    let wrong = |why: &str| Error::new(format_args!("--light {text}: {why}"));
    let mut parts = text.split(':');
    let kind = parts.next().unwrap_or_default();
    let form = match kind {
        "point" => "point:x,y,z",
        "sphere" => "sphere:x,y,z:RADIUS",
        "sun" => "sun:dx,dy,dz:DEGREES",
        "linear" => "linear:x,y,z:x,y,z",
        "triangle" => "triangle:x,y,z:x,y,z:x,y,z",
        "rect" => "rect:x,y,z:edge:edge",
        _ => return Err(wrong("expected point:, sphere:, sun:, linear:, triangle: or rect:")),
    };
    let expected = || wrong(&format!("expected {form}"));
    let next =
        |parts: &mut std::str::Split<'_, char>| parts.next().and_then(vector).ok_or_else(expected);
    let first = next(&mut parts)?;
    let light = match kind {
        "point" => Light::Point { position: first },
        "sphere" => {
            let radius = parts.next().and_then(finite).ok_or_else(expected)?;
            if !(0.0..=1e6).contains(&radius) {
                return Err(wrong("the radius must be from 0 to 1e6 metres"));
            }
            Light::Sphere { center: first, radius }
        }
        "sun" => {
            let degrees = parts.next().and_then(finite).ok_or_else(expected)?;
            if !(0.0..=90.0).contains(&degrees) {
                return Err(wrong("the angle must be from 0 to 90 degrees"));
            }
            if first.length() < 1e-6 {
                return Err(wrong("the direction has no length"));
            }
            Light::Sun { direction: first.normalize(), angle: degrees.to_radians() }
        }
        "linear" => {
            let b = next(&mut parts)?;
            if first.distance(b) < 1e-6 {
                return Err(wrong("the two ends are the same point"));
            }
            Light::Linear { a: first, b }
        }
        "triangle" => {
            let (b, c) = (next(&mut parts)?, next(&mut parts)?);
            if (b - first).cross(c - first).length() < 1e-9 {
                return Err(wrong("the three corners lie on a line"));
            }
            Light::Triangle { a: first, b, c }
        }
        _ => {
            let (edge_u, edge_v) = (next(&mut parts)?, next(&mut parts)?);
            if edge_u.cross(edge_v).length() < 1e-9 {
                return Err(wrong("the two edges lie on a line"));
            }
            Light::Rectangle { corner: first, edge_u, edge_v }
        }
    };
    if parts.next().is_some() { Err(expected()) } else { Ok(light) }
}

fn finite(text: &str) -> Option<f32> {
    text.trim().parse::<f32>().ok().filter(|value| value.is_finite())
}

fn vector(text: &str) -> Option<Vec3> {
    let mut parts = text.split(',').map(|part| finite(part).filter(|value| value.abs() <= 1e6));
    let vector = Vec3::new(parts.next()??, parts.next()??, parts.next()??);
    parts.next().is_none().then_some(vector)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_of_every_kind() {
        let v = Vec3::new;
        let lights = [
            ("point:1,2,3", Light::Point { position: v(1.0, 2.0, 3.0) }),
            ("sphere:1,-2,3:0.5", Light::Sphere { center: v(1.0, -2.0, 3.0), radius: 0.5 }),
            (
                "sun:0,-2,0:90",
                Light::Sun { direction: v(0.0, -1.0, 0.0), angle: std::f32::consts::FRAC_PI_2 },
            ),
            ("linear:-1,4,0:1,4,0", Light::Linear { a: v(-1.0, 4.0, 0.0), b: v(1.0, 4.0, 0.0) }),
            (
                "triangle:0,0,0:1,0,0:0,0,1",
                Light::Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Z },
            ),
            (
                "rect:0,4,0:1,0,0:0,0,1",
                Light::Rectangle { corner: v(0.0, 4.0, 0.0), edge_u: Vec3::X, edge_v: Vec3::Z },
            ),
        ];
        for (text, expected) in lights {
            assert_eq!(light(text).unwrap(), expected, "{text}");
        }
    }

    #[test]
    fn what_is_no_light_says_why() {
        for (text, why) in [
            ("", "expected point:"),
            ("lamp:1,2,3", "expected point:"),
            ("point:1,2", "expected point:x,y,z"),
            ("point:1,2,3,4", "expected point:x,y,z"),
            ("point:1,2,3:4", "expected point:x,y,z"),
            ("point:nan,0,0", "expected point:x,y,z"),
            ("point:inf,0,0", "expected point:x,y,z"),
            ("sphere:1,2,3", "expected sphere:x,y,z:RADIUS"),
            ("sphere:1,2,3:-1", "radius"),
            ("sphere:1,2,3:nan", "expected sphere"),
            ("sun:0,0,0:1", "no length"),
            ("sun:0,-1,0:91", "angle"),
            ("linear:1,2,3:1,2,3", "same point"),
            ("linear:1,2,3", "expected linear"),
            ("triangle:0,0,0:1,0,0:2,0,0", "on a line"),
            ("rect:0,0,0:1,0,0:2,0,0", "on a line"),
        ] {
            let message = light(text).unwrap_err().to_string();
            assert!(message.contains(why), "{text}: {message}");
        }
    }

    #[test]
    fn sizes_and_numbers_have_bounds() {
        assert_eq!(size("--size", "640x480").unwrap(), [640, 480]);
        for text in ["0x1", "1x0", "x", "3", "16385x1", "-1x1", "1x1x1", "1.5x2", ""] {
            assert!(size("--size", text).is_err(), "{text}");
        }
        assert_eq!(count("--threads", "8", 1..=8).unwrap(), 8);
        for text in ["0", "9", "-1", "1e3", ""] {
            assert!(count("--threads", text, 1..=8).is_err(), "{text}");
        }
        assert!(field_of_view("--fov", "90").unwrap() > 1.57);
        for text in ["0", "180", "nan", "-5"] {
            assert!(field_of_view("--fov", text).is_err(), "{text}");
        }
        assert!(point("--eye", "1e7,0,0").is_err());
    }
}

//! PLY: the body of the file.

use super::Soup;
use super::bytes::Bytes;
use super::error::{Fault, MeshReadError, Place};
use super::ply_header::{self, Element, Encoding, Header, Kind};
use super::text::{Lines, number, words};
use nalgebra::Point3;

/// Corners of the largest face that is read before it is refused.
const MOST_CORNERS: usize = 255;

pub(super) fn read(bytes: &[u8]) -> Result<Soup, MeshReadError> {
    let header = ply_header::read(bytes)?;
    let mut soup = Soup::default();
    match header.encoding {
        Encoding::Text => {
            let mut lines = Lines::new(bytes);
            lines.by_ref().take(header.lines).for_each(drop);
            let mut source = TextSource {
                lines,
                words: Vec::new(),
                at: 0,
            };
            body(&header, &mut source, &mut soup)?;
        }
        Encoding::Binary(order) => {
            let mut source = BinarySource {
                bytes: Bytes::new(bytes, header.body, order),
            };
            body(&header, &mut source, &mut soup)?;
        }
    }
    Ok(soup)
}

/// Where numbers come from.
trait Source {
    /// Before the items of an element.
    ///
    /// # Errors
    /// The file cannot hold so many.
    fn begin(&mut self, element: &Element) -> Result<(), MeshReadError>;
    /// Before an item; its place in the file.
    fn item(&mut self, element: Place) -> Result<Place, MeshReadError>;
    /// The next number.
    fn next(&mut self, kind: super::bytes::Scalar) -> Result<f64, MeshReadError>;
    /// Passes over numbers.
    fn skip(&mut self, kind: super::bytes::Scalar, count: usize) -> Result<(), MeshReadError>;
    /// After an item.
    fn end(&mut self) -> Result<(), MeshReadError>;
}

fn body(header: &Header, source: &mut impl Source, soup: &mut Soup) -> Result<(), MeshReadError> {
    for element in &header.elements {
        source.begin(element)?;
        match element.name.as_str() {
            "vertex" => vertices(element, source, soup)?,
            "face" => faces(element, source, soup)?,
            _ => {
                for index in 0..element.count {
                    source.item(Place::Vertex(index))?;
                    read_item(element, source, |_, _| {})?;
                }
            }
        }
    }
    Ok(())
}

/// Reads an item, handing each number of a single property, and each item of
/// a list, over with the property's place.
fn read_item(
    element: &Element,
    source: &mut impl Source,
    mut take: impl FnMut(usize, f64),
) -> Result<(), MeshReadError> {
    for (place, property) in element.properties.iter().enumerate() {
        match property.kind {
            Kind::One(kind) => take(place, source.next(kind)?),
            Kind::List { count, item } => {
                let count = whole(source.next(count)?).unwrap_or(0);
                let kept = count.min(MOST_CORNERS);
                for _ in 0..kept {
                    take(place, source.next(item)?);
                }
                source.skip(item, count - kept)?;
            }
        }
    }
    source.end()
}

fn vertices(
    element: &Element,
    source: &mut impl Source,
    soup: &mut Soup,
) -> Result<(), MeshReadError> {
    let mut at = [0; 3];
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        let missing = Fault::Header("the vertices have no x, y and z");
        let missing = || MeshReadError::new(Place::Line(element.line), name, missing);
        at[axis] = element.position(&[name]).ok_or_else(missing)?;
    }
    for index in 0..element.count {
        let place = source.item(Place::Vertex(index))?;
        let mut x = [f64::NAN; 3];
        read_item(element, source, |property, value| {
            for axis in 0..3 {
                if at[axis] == property {
                    x[axis] = value;
                }
            }
        })?;
        if let Some(odd) = x.iter().find(|x| !x.is_finite()) {
            return Err(MeshReadError::new(
                place,
                &odd.to_string(),
                Fault::NotANumber,
            ));
        }
        soup.vertices.push(Point3::from(x));
    }
    Ok(())
}

fn faces(
    element: &Element,
    source: &mut impl Source,
    soup: &mut Soup,
) -> Result<(), MeshReadError> {
    let list = element.position(&["vertex_indices", "vertex_index"]);
    let missing = Fault::Header("the faces have no vertex_indices");
    let list = list
        .filter(|at| matches!(element.properties[*at].kind, Kind::List { .. }))
        .ok_or_else(|| MeshReadError::new(Place::Line(element.line), "face", missing))?;
    let mut corners = Vec::with_capacity(4);
    for index in 0..element.count {
        let place = source.item(Place::Face(index))?;
        corners.clear();
        let mut odd = None;
        read_item(element, source, |property, value| {
            if property == list {
                match whole(value) {
                    Some(corner) => corners.push(corner),
                    None => odd = Some(value),
                }
            }
        })?;
        if let Some(odd) = odd {
            return Err(MeshReadError::new(
                place,
                &odd.to_string(),
                Fault::NotAnIndex,
            ));
        }
        soup.push(&corners, place)?;
    }
    Ok(())
}

/// A number as an index or a count.
fn whole(x: f64) -> Option<usize> {
    let fits = x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    fits.then_some(x as usize)
}

struct BinarySource<'a> {
    bytes: Bytes<'a>,
}

impl Source for BinarySource<'_> {
    fn begin(&mut self, element: &Element) -> Result<(), MeshReadError> {
        let least = element.least_bytes().max(1);
        if element.count > self.bytes.left() / least {
            let found = format!("{} × {}", element.count, element.name);
            let place = Place::Line(element.line);
            return Err(MeshReadError::new(place, &found, Fault::Promises));
        }
        Ok(())
    }

    fn item(&mut self, element: Place) -> Result<Place, MeshReadError> {
        Ok(element)
    }

    fn next(&mut self, kind: super::bytes::Scalar) -> Result<f64, MeshReadError> {
        self.bytes.scalar(kind)
    }

    fn skip(&mut self, kind: super::bytes::Scalar, count: usize) -> Result<(), MeshReadError> {
        self.bytes.skip(count.saturating_mul(kind.size()))
    }

    fn end(&mut self) -> Result<(), MeshReadError> {
        Ok(())
    }
}

/// One item a line.
struct TextSource<'a> {
    lines: Lines<'a>,
    words: Vec<String>,
    at: usize,
}

impl TextSource<'_> {
    fn fail(&self, found: &str, fault: Fault) -> MeshReadError {
        MeshReadError::new(Place::Line(self.lines.number()), found, fault)
    }
}

impl Source for TextSource<'_> {
    fn begin(&mut self, _: &Element) -> Result<(), MeshReadError> {
        Ok(())
    }

    fn item(&mut self, _: Place) -> Result<Place, MeshReadError> {
        loop {
            let next = self.lines.next();
            let (line, text) = next.ok_or_else(|| self.fail("", Fault::EndsEarly))?;
            if !text.trim().is_empty() {
                self.words = words(&text).map(str::to_owned).collect();
                self.at = 0;
                return Ok(Place::Line(line));
            }
        }
    }

    fn next(&mut self, _: super::bytes::Scalar) -> Result<f64, MeshReadError> {
        let word = self.words.get(self.at);
        let word = word.ok_or_else(|| self.fail("", Fault::EndsEarly))?;
        self.at += 1;
        number(word, self.lines.number())
    }

    fn skip(&mut self, _: super::bytes::Scalar, count: usize) -> Result<(), MeshReadError> {
        let left = self.words.len() - self.at;
        if count > left {
            return Err(self.fail("", Fault::EndsEarly));
        }
        self.at += count;
        Ok(())
    }

    fn end(&mut self) -> Result<(), MeshReadError> {
        match self.words.get(self.at) {
            Some(word) => Err(self.fail(word, Fault::LeftOver)),
            None => Ok(()),
        }
    }
}

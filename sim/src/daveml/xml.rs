//! A document's elements, with the place that an error names.
//!
//! Invariants: a document that opens is at most [`MAX_DEPTH`] elements deep, so recursion over it is bounded; it defines
//! no entities, so it is no larger than its text; names are compared without their namespace.

use super::error::{DavemlError, Place};
use roxmltree::{Document, Node, ParsingOptions};

/// Deepest nesting of elements. Models of aircraft stay below 30.
pub const MAX_DEPTH: usize = 200;
/// Longest text of a document, bytes.
const MAX_BYTES: usize = 64 << 20;
/// Longest tag, bytes: the parser compares the attributes of a tag in pairs.
const MAX_TAG_BYTES: usize = 16 << 10;
/// Most namespace declarations: the parser copies those in force wherever one is added. Models have one a calculation.
const MAX_NAMESPACES: usize = 20_000;

/// An element and the name of the variable, function or shot that it belongs to.
#[derive(Debug, Clone)]
pub struct Element<'a, 'input> {
    node: Node<'a, 'input>,
    owner: &'a str,
    lines: &'a Lines,
}

/// Where lines begin: the parser itself would count them from the start for each place.
#[derive(Debug)]
pub struct Lines(Vec<usize>);

impl Lines {
    /// Of a text.
    pub fn of(text: &str) -> Self {
        Self(text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at).collect())
    }

    /// The line of a byte, from 1.
    fn line(&self, at: usize) -> u32 {
        self.0.partition_point(|&end| end < at) as u32 + 1
    }
}

/// Parses a text, within the bounds of this reader.
pub fn open(text: &str) -> Result<Document<'_>, DavemlError> {
    if text.len() > MAX_BYTES {
        return Err(DavemlError::Xml(format!("expected at most {MAX_BYTES} bytes, found {}", text.len())));
    }
    // An entity in an entity multiplies; no model needs one of its own.
    if text.contains("<!ENTITY") {
        return Err(DavemlError::Xml("entity declarations are not supported".into()));
    }
    if text.matches("xmlns").nth(MAX_NAMESPACES).is_some() {
        return Err(DavemlError::Xml(format!("more than {MAX_NAMESPACES} namespace declarations")));
    }
    refuse_long_tags(text)?;
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| DavemlError::Xml(error.to_string()))?;
    let mut depths = vec![0usize; document.descendants().count()];
    for node in document.descendants() {
        let depth = node.parent().map_or(0, |parent| depths[parent.id().get_usize()] + 1);
        if depth > MAX_DEPTH {
            let line = document.text_pos_at(node.range().start).row;
            return Err(DavemlError::Depth { line, limit: MAX_DEPTH });
        }
        depths[node.id().get_usize()] = depth;
    }
    Ok(document)
}

fn refuse_long_tags(text: &str) -> Result<(), DavemlError> {
    let mut rest = text.as_bytes();
    while let Some(start) = rest.iter().position(|&byte| byte == b'<') {
        rest = &rest[start + 1..];
        if matches!(rest.first(), Some(b'!' | b'?')) {
            continue;
        }
        let end = rest.iter().position(|&byte| byte == b'>').unwrap_or(rest.len());
        if end > MAX_TAG_BYTES {
            return Err(DavemlError::Xml(format!("a tag is longer than {MAX_TAG_BYTES} bytes")));
        }
        rest = &rest[end..];
    }
    Ok(())
}

/// A finite number; an infinity or NaN is none.
pub fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|value: &f64| value.is_finite())
}

impl<'a, 'input> Element<'a, 'input> {
    /// The outermost element.
    pub fn root(document: &'a Document<'input>, lines: &'a Lines) -> Self {
        Self { node: document.root_element(), owner: "", lines }
    }

    /// Its name.
    pub fn name(&self) -> &'a str {
        self.node.tag_name().name()
    }

    /// The same element, as the one that errors name for itself and those inside.
    pub fn named(&self, owner: &'a str) -> Self {
        Self { node: self.node, owner, lines: self.lines }
    }

    /// The elements in it.
    pub fn children(&self) -> impl Iterator<Item = Self> + use<'a, 'input> {
        let (owner, lines) = (self.owner, self.lines);
        self.node.children().filter(Node::is_element).map(move |node| Self { node, owner, lines })
    }

    /// The one child of a name; `None` if there is none.
    pub fn child(&self, name: &str) -> Result<Option<Self>, DavemlError> {
        let mut found = self.children().filter(|child| child.name() == name);
        let first = found.next();
        if found.next().is_some() {
            return Err(self.expected(&format!("at most one <{name}> in <{}>", self.name())));
        }
        Ok(first)
    }

    /// The child of a name that must be there.
    pub fn required(&self, name: &str) -> Result<Self, DavemlError> {
        self.child(name)?.ok_or_else(|| self.expected(&format!("<{name}> in <{}>", self.name())))
    }

    /// An attribute.
    pub fn attribute(&self, name: &str) -> Option<&'a str> {
        self.node.attribute(name)
    }

    /// An attribute that must be there and not be empty.
    pub fn required_attribute(&self, name: &str) -> Result<&'a str, DavemlError> {
        let value = self.attribute(name).map(str::trim).filter(|value| !value.is_empty());
        value.ok_or_else(|| self.expected(&format!("{name} of <{}>", self.name())))
    }

    /// An attribute that is a finite number; `None` if it is not there.
    pub fn number_attribute(&self, name: &str) -> Result<Option<f64>, DavemlError> {
        self.attribute(name).map(|text| number(text).ok_or_else(|| self.no_number(text))).transpose()
    }

    /// Its own text: all pieces between comments and children.
    pub fn text(&self) -> String {
        self.texts().concat()
    }

    /// The pieces of its own text.
    pub fn texts(&self) -> Vec<&'a str> {
        self.node.children().filter(Node::is_text).filter_map(|node| node.text()).collect()
    }

    /// Its text as finite numbers, parted by commas, semicolons or white space.
    pub fn numbers(&self) -> Result<Vec<f64>, DavemlError> {
        // Pieces are parted by comments, which part numbers too.
        let texts = self.texts();
        let parts = texts.iter().flat_map(|text| text.split(|c: char| c.is_whitespace() || c == ',' || c == ';'));
        let parts = parts.filter(|part| !part.is_empty());
        parts.map(|part| number(part).ok_or_else(|| self.no_number(part))).collect()
    }

    /// Its line and owner.
    pub fn place(&self) -> Place {
        let line = self.lines.line(self.node.range().start);
        Place { line, owner: shortened(self.owner) }
    }

    /// An error that something is missing, or there too often.
    pub fn expected(&self, what: &str) -> DavemlError {
        DavemlError::Element { place: self.place(), expected: what.into() }
    }

    /// An error that this element is not known here.
    pub fn unsupported(&self) -> DavemlError {
        self.unsupported_what(format!("<{}>", shortened(self.name())))
    }

    /// An error that something about this element is not known.
    pub fn unsupported_what(&self, what: String) -> DavemlError {
        DavemlError::Unsupported { place: self.place(), what }
    }

    /// An error that a text is no finite number.
    pub fn no_number(&self, text: &str) -> DavemlError {
        DavemlError::Number { place: self.place(), text: shortened(text) }
    }

    /// An error that a name is not defined.
    pub fn unknown(&self, kind: &'static str, name: &str) -> DavemlError {
        DavemlError::Unknown { place: self.place(), kind, name: shortened(name) }
    }

    /// An error that a name is defined twice.
    pub fn duplicate(&self, kind: &'static str, name: &str) -> DavemlError {
        DavemlError::Duplicate { place: self.place(), kind, name: shortened(name) }
    }
}

/// What of a name or text fits a message.
fn shortened(text: &str) -> String {
    text.chars().take(80).collect()
}

//! Messages with the bytes that they have on the wire, drawn from the types.

use std::collections::{BTreeMap, BTreeSet};

use fmc_camera::io::link::PROTOCOL_VERSION;
use fmc_camera::io::link::message::{Answer, Header, Request};
use fmc_camera::io::link::packet::{Packet, PacketReceiver};
use serde_json::{Map, Value, json};
use serde_reflection::{ContainerFormat, Format, Named, Registry, VariantFormat};

/// Messages drawn one after the other that bring nothing new before a variant is left.
const DRAWN_IN_VAIN: u32 = 5;

/// Whole numbers whose variable-length forms have one byte to five.
const NUMBERS: [u64; 9] = [1, 127, 128, 300, 65_535, 16_384, 3, 70_000, 4_000_000_000];

/// Numbers that 32 bits hold exactly.
const REALS: [f32; 6] = [0.5, -1.25, 3.0, 0.0625, -1024.5, 96.0];

/// Draws values of types, each time with the next of their possibilities.
struct Draw<'a> {
    registry: &'a Registry,
    /// Number of times that each type has been drawn.
    drawn: BTreeMap<String, usize>,
    bytes: Vec<u8>,
    /// Variants of the value, by type and number.
    variants: BTreeSet<(String, usize)>,
    /// Those of the values before.
    seen: BTreeSet<(String, usize)>,
    /// Variant that the value begins with.
    first: Option<usize>,
}

/// Returns the messages, each variant of each type at least once.
pub(super) fn vectors(registry: &Registry) -> Vec<Value> {
    let mut draw = Draw {
        registry,
        drawn: BTreeMap::new(),
        bytes: Vec::new(),
        variants: BTreeSet::new(),
        seen: BTreeSet::new(),
        first: None,
    };
    let mut vectors = Vec::new();
    for kind in ["Request", "Answer"] {
        let ContainerFormat::Enum(variants) = &registry[kind] else {
            panic!("{kind} is an enumeration");
        };
        for number in variants.keys() {
            let mut in_vain = 0;
            while in_vain < DRAWN_IN_VAIN {
                draw.bytes.clear();
                draw.variants.clear();
                draw.first = usize::try_from(*number).ok();
                let value = draw.value(&Format::TypeName(kind.to_owned()));
                if draw.variants.is_subset(&draw.seen) {
                    in_vain += 1;
                    continue;
                }
                in_vain = 0;
                draw.seen.append(&mut draw.variants);
                let header = Header {
                    session: u32::try_from(300 + 7919 * vectors.len()).unwrap(),
                    sequence: u16::try_from(vectors.len()).unwrap(),
                };
                vectors.push(vector(kind, header, &draw.bytes, &value));
            }
        }
    }
    for (name, container) in registry {
        if let ContainerFormat::Enum(variants) = container {
            for (number, variant) in variants {
                let one = (name.clone(), usize::try_from(*number).unwrap());
                assert!(
                    draw.seen.contains(&one) || !is_in_messages(registry, name),
                    "{name}::{} is in no message",
                    variant.name
                );
            }
        }
    }
    vectors
}

/// Returns `true` for a type that a message contains.
fn is_in_messages(registry: &Registry, name: &str) -> bool {
    let mut found = BTreeSet::from(["Request".to_owned(), "Answer".to_owned()]);
    loop {
        let mut more = found.clone();
        for one in &found {
            let text = serde_json::to_string(&registry[one]).unwrap();
            let names = text.split("{\"TYPENAME\":\"").skip(1);
            more.extend(names.filter_map(|rest| Some(rest.split_once('"')?.0.to_owned())));
        }
        if more.len() == found.len() {
            return found.contains(name);
        }
        found = more;
    }
}

/// A message as its vector. The types read it, and write the same bytes.
fn vector(kind: &str, header: Header, body: &[u8], value: &Value) -> Value {
    let mut room = [0; 8];
    let encoded = postcard::to_slice(&header, &mut room).unwrap();
    let payload = [&[PROTOCOL_VERSION], &*encoded, body].concat();
    let mut packet = Packet::EMPTY;
    if kind == "Request" {
        let (read, request) = Request::read(&payload).unwrap();
        assert_eq!(read, header);
        let request = request.unwrap_or_else(|| panic!("no request: {value}"));
        request.write(header, &mut packet).unwrap();
    } else {
        let (read, answer) = Answer::read(&payload).unwrap();
        assert_eq!(read, header);
        let answer = answer.unwrap_or_else(|| panic!("no answer: {value}"));
        answer.write(header, &mut packet).unwrap();
    }
    let mut receiver = PacketReceiver::new();
    let mut received = None;
    for byte in packet.bytes() {
        if let Some(one) = receiver.receive(*byte) {
            received = Some(one.unwrap().to_vec());
        }
    }
    assert_eq!(received.as_ref(), Some(&payload), "{value}");
    json!({
        "type": kind,
        "session": header.session,
        "sequence": header.sequence,
        "value": value,
        "payload": hex(&payload),
        "packet": hex(packet.bytes()),
    })
}

fn hex(bytes: &[u8]) -> String {
    let digit = |half: u8| char::from_digit(half.into(), 16).unwrap();
    let digits = bytes.iter().flat_map(|byte| [byte >> 4, byte & 15]);
    digits.map(digit).collect()
}

impl Draw<'_> {
    /// Number of times that a type has been drawn before.
    fn times(&mut self, name: &str) -> usize {
        let times = self.drawn.entry(name.to_owned()).or_default();
        *times += 1;
        *times - 1
    }

    /// Draws one of the possibilities of a type, each with its contents: one that is new, or has
    /// something new within, if there is one.
    fn choice(&mut self, name: &str, contents: &[Vec<&Format>]) -> usize {
        let times = self.times(name);
        let unseen = (0..contents.len()).find(|number| self.is_unseen(name, *number));
        let within = || contents.iter().position(|one| self.has_unseen(one));
        let number = unseen.or_else(within).unwrap_or(times % contents.len());
        self.variants.insert((name.to_owned(), number));
        number
    }

    fn is_unseen(&self, name: &str, number: usize) -> bool {
        let one = (name.to_owned(), number);
        !self.seen.contains(&one) && !self.variants.contains(&one)
    }

    /// Returns `true` if there is a possibility within some contents that has not been seen.
    fn has_unseen(&self, contents: &[&Format]) -> bool {
        contents.iter().any(|format| match format {
            Format::TypeName(name) => match &self.registry[name] {
                ContainerFormat::Enum(variants) => variants.iter().any(|(number, variant)| {
                    self.is_unseen(name, usize::try_from(*number).unwrap())
                        || self.has_unseen(&inside(&variant.value))
                }),
                ContainerFormat::Struct(fields) => {
                    let fields: Vec<&Format> = fields.iter().map(|field| &field.value).collect();
                    self.has_unseen(&fields)
                }
                ContainerFormat::NewTypeStruct(content) => self.has_unseen(&[content]),
                _ => false,
            },
            Format::Option(content) => {
                (0..2).any(|number| self.is_unseen(&format!("{content:?}"), number))
                    || self.has_unseen(&[content])
            }
            Format::Seq(content) => self.has_unseen(&[content]),
            _ => false,
        })
    }

    /// Draws a value and writes its bytes.
    fn value(&mut self, format: &Format) -> Value {
        match format {
            Format::TypeName(name) => self.container(name),
            Format::Unit => Value::Null,
            Format::Bool => {
                let value = self.times("bool") % 2 == 1;
                self.bytes.push(value.into());
                value.into()
            }
            Format::U8 => {
                // Characters of a serial number, too.
                let value = b'A' + u8::try_from(self.times("u8") % 26).unwrap();
                self.bytes.push(value);
                value.into()
            }
            Format::U16 => self.number("u16", u64::from(u16::MAX)),
            Format::U32 => self.number("u32", u64::from(u32::MAX)),
            Format::U64 => self.number("u64", u64::MAX),
            Format::I16 | Format::I32 | Format::I64 => {
                let value = [-1, 1, -64, 64, -300][self.times("i") % 5];
                let zigzag = u64::try_from(if value < 0 { -2 * value - 1 } else { 2 * value });
                self.varint(zigzag.unwrap());
                value.into()
            }
            Format::F32 => {
                let value = REALS[self.times("f32") % REALS.len()];
                self.bytes.extend(value.to_le_bytes());
                value.into()
            }
            Format::F64 => {
                let value = f64::from(REALS[self.times("f64") % REALS.len()]);
                self.bytes.extend(value.to_le_bytes());
                value.into()
            }
            Format::Str => {
                let text = ["0.1.0", "", "µm"][self.times("str") % 3];
                self.varint(text.len().try_into().unwrap());
                self.bytes.extend(text.bytes());
                text.into()
            }
            Format::Option(content) => {
                let name = format!("{content:?}");
                let is_some = self.choice(&name, &[vec![&**content], Vec::new()]) == 0;
                self.bytes.push(is_some.into());
                if is_some {
                    self.value(content)
                } else {
                    Value::Null
                }
            }
            Format::Seq(content) => {
                let count = 1 + self.times("seq") % 2;
                self.varint(count.try_into().unwrap());
                (0..count).map(|_| self.value(content)).collect()
            }
            Format::Tuple(contents) => contents.iter().map(|one| self.value(one)).collect(),
            Format::TupleArray { content, size } => {
                (0..*size).map(|_| self.value(content)).collect()
            }
            other => panic!("the link has no {other:?}"),
        }
    }

    fn number(&mut self, name: &str, largest: u64) -> Value {
        let numbers = NUMBERS.into_iter().filter(|number| *number <= largest);
        let numbers: Vec<u64> = numbers.collect();
        let value = numbers[self.times(name) % numbers.len()];
        self.varint(value);
        value.into()
    }

    fn varint(&mut self, mut number: u64) {
        while number > 0x7F {
            self.bytes.push(u8::try_from(number & 0x7F).unwrap() | 0x80);
            number >>= 7;
        }
        self.bytes.push(number.try_into().unwrap());
    }

    fn container(&mut self, name: &str) -> Value {
        match &self.registry[name] {
            ContainerFormat::UnitStruct => Value::Null,
            ContainerFormat::NewTypeStruct(content) => self.value(content),
            ContainerFormat::TupleStruct(contents) => {
                contents.iter().map(|one| self.value(one)).collect()
            }
            ContainerFormat::Struct(fields) => self.fields(fields),
            ContainerFormat::Enum(variants) => {
                let number = if let Some(first) = self.first.take() {
                    self.variants.insert((name.to_owned(), first));
                    first
                } else {
                    let contents = variants.values().map(|it| inside(&it.value));
                    self.choice(name, &contents.collect::<Vec<_>>())
                };
                self.varint(number.try_into().unwrap());
                let variant = &variants[&u32::try_from(number).unwrap()];
                let content = match &variant.value {
                    VariantFormat::Unit => return variant.name.clone().into(),
                    VariantFormat::NewType(content) => self.value(content),
                    VariantFormat::Tuple(contents) => {
                        contents.iter().map(|one| self.value(one)).collect()
                    }
                    VariantFormat::Struct(fields) => self.fields(fields),
                    VariantFormat::Variable(_) => panic!("{name}: not traced"),
                };
                json!({ &variant.name: content })
            }
        }
    }

    fn fields(&mut self, fields: &[Named<Format>]) -> Value {
        let fields = fields
            .iter()
            .map(|field| (field.name.clone(), self.value(&field.value)));
        Value::Object(fields.collect::<Map<_, _>>())
    }
}

/// Formats of a variant's contents.
fn inside(variant: &VariantFormat) -> Vec<&Format> {
    match variant {
        VariantFormat::NewType(content) => vec![content],
        VariantFormat::Tuple(contents) => contents.iter().collect(),
        VariantFormat::Struct(fields) => fields.iter().map(|field| &field.value).collect(),
        VariantFormat::Unit | VariantFormat::Variable(_) => Vec::new(),
    }
}

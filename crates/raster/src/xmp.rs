//! XMP packet (tag 700) of a rectified frame.
//!
//! The camera is described by the namespace that Pix4D specifies ("Specifications of XMP camera
//! tags", PIX4Dmapper). Keys that ask other software to correct the lens once more are dropped, the
//! rest of the packet stays as it is.

use std::fmt::Write as _;

use quick_xml::events::attributes::Attribute;
use quick_xml::events::{BytesEnd, BytesStart, BytesText, Event};
use quick_xml::name::{LocalName, QName, ResolveResult};
use quick_xml::{NsReader, Writer};

/// Namespace of the camera, with or without a slash at its end.
const CAMERA: &str = "http://pix4d.com/camera/1.0";
const RDF: &str = "http://www.w3.org/1999/02/22-rdf-syntax-ns#";

/// Keys of the camera that are set anew.
const SET: [&str; 4] = [
    "ModelType",
    "PerspectiveDistortion",
    "PerspectiveFocalLength",
    "PrincipalPoint",
];
/// Keys of the camera's namespace that describe another lens.
const OTHER_LENS: [&str; 3] = [
    "FisheyeAffineMatrix",
    "FisheyeAffineSymmetric",
    "FisheyePolynomial",
];
/// Keys of any namespace that ask other software to correct the lens once more (DJI, Adobe Camera
/// Raw).
const CORRECTIONS: [&str; 15] = [
    "CalibratedFocalLength",
    "CalibratedHMatrix",
    "CalibratedOpticalCenterX",
    "CalibratedOpticalCenterY",
    "DewarpData",
    "DewarpFlag",
    "DewarpHMatrix",
    "LensManualDistortionAmount",
    "LensProfileDigest",
    "LensProfileDistortionScale",
    "LensProfileEnable",
    "LensProfileFilename",
    "LensProfileIsEmbedded",
    "LensProfileName",
    "LensProfileSetup",
];

const EMPTY: &str = "<?xpacket begin=\"\u{feff}\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n\
    <x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n\
    <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n\
    </rdf:RDF>\n\
    </x:xmpmeta>\n\
    <?xpacket end=\"w\"?>";

/// Camera of a rectified frame: without distortion, the principal point in the frame's corner
/// coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RectifiedCamera {
    /// Principal distance.
    pub focal_length_mm: f64,
    /// Principal point from the upper left corner of the upper left pixel: to the right, down.
    pub principal_point_mm: [f64; 2],
}

/// A packet with the camera of a rectified frame.
#[derive(Debug)]
pub(crate) struct Packet {
    pub(crate) text: String,
    /// Names of the keys that were dropped, as they were written.
    pub(crate) dropped: Vec<String>,
}

impl Packet {
    /// Returns a packet of the camera alone.
    pub(crate) fn of(camera: &RectifiedCamera) -> Option<Self> {
        Self::edited(EMPTY, camera)
    }

    /// Sets the camera in a packet; none where the packet is no XMP.
    pub(crate) fn edited(packet: &str, camera: &RectifiedCamera) -> Option<Self> {
        let mut reader = NsReader::from_str(packet);
        let mut editing = Editing {
            writer: Writer::new(Vec::new()),
            dropped: Vec::new(),
            about: String::new(),
            namespace: CAMERA.to_owned(),
        };
        let (mut is_set, mut depth) = (false, 0_usize);
        loop {
            if depth > DEEPEST {
                return None;
            }
            match reader.read_event().ok()? {
                Event::Eof => break,
                Event::Start(start) => {
                    if editing.drops(&reader, start.name(), true) {
                        reader.read_to_end(start.name()).ok()?;
                    } else {
                        depth += 1;
                        let start = editing.kept(&reader, &start)?;
                        editing.write(Event::Start(start))?;
                    }
                }
                Event::Empty(start) if is_rdf(&reader, start.name(), "RDF") => {
                    let start = editing.kept(&reader, &start)?;
                    editing.write(Event::Start(start.borrow()))?;
                    editing.set(camera)?;
                    is_set = true;
                    editing.write(Event::End(start.to_end()))?;
                }
                Event::Empty(start) => {
                    if !editing.drops(&reader, start.name(), true) {
                        let start = editing.kept(&reader, &start)?;
                        editing.write(Event::Empty(start))?;
                    }
                }
                Event::End(end) => {
                    depth = depth.saturating_sub(1);
                    if !is_set && is_rdf_end(&end) {
                        editing.set(camera)?;
                        is_set = true;
                    }
                    editing.write(Event::End(end))?;
                }
                other => editing.write(other)?,
            }
        }
        is_set.then_some(())?;
        Some(Self {
            text: String::from_utf8(editing.writer.into_inner()).ok()?,
            dropped: editing.dropped,
        })
    }
}

/// Elements within each other; a packet with more is not one of a camera.
const DEEPEST: usize = 256;

/// A packet that is being edited.
struct Editing {
    writer: Writer<Vec<u8>>,
    dropped: Vec<String>,
    /// Subject of the packet's descriptions (`rdf:about`).
    about: String,
    /// The camera's namespace as the packet writes it.
    namespace: String,
}

impl Editing {
    fn write(&mut self, event: Event<'_>) -> Option<()> {
        self.writer.write_event(event).ok()
    }

    /// Returns whether a key is dropped, and notes it unless it is set anew.
    fn drops(&mut self, reader: &NsReader<&[u8]>, key: QName<'_>, is_element: bool) -> bool {
        let (namespace, local) = if is_element {
            reader.resolver().resolve_element(key)
        } else {
            reader.resolver().resolve_attribute(key)
        };
        let is_one_of = |names: &[&str]| names.iter().any(|name| is_named(local, name));
        if let ResolveResult::Bound(namespace) = namespace
            && let Ok(namespace) = std::str::from_utf8(namespace.into_inner())
            && namespace.strip_suffix('/').unwrap_or(namespace) == CAMERA
        {
            namespace.clone_into(&mut self.namespace);
            if is_one_of(&SET) {
                return true;
            }
            if is_one_of(&OTHER_LENS) {
                self.note(key);
                return true;
            }
        }
        if is_one_of(&CORRECTIONS) {
            self.note(key);
            return true;
        }
        false
    }

    fn note(&mut self, key: QName<'_>) {
        let name = String::from_utf8_lossy(key.into_inner()).into_owned();
        if !self.dropped.contains(&name) {
            self.dropped.push(name);
        }
    }

    /// Returns an element without the attributes that are dropped.
    fn kept<'a>(
        &mut self,
        reader: &NsReader<&[u8]>,
        start: &BytesStart<'a>,
    ) -> Option<BytesStart<'a>> {
        let is_description = is_rdf(reader, start.name(), "Description");
        let mut kept: Vec<Attribute<'_>> = Vec::new();
        let mut is_whole = true;
        for attribute in start.attributes() {
            let attribute = attribute.ok()?;
            if is_description && is_named(attribute.key.local_name(), "about") {
                let about = std::str::from_utf8(&attribute.value).ok()?;
                about.clone_into(&mut self.about);
            }
            if self.drops(reader, attribute.key, false) {
                is_whole = false;
            } else {
                kept.push(attribute);
            }
        }
        if is_whole {
            return Some(start.clone());
        }
        let mut edited = start.clone();
        edited.clear_attributes();
        for attribute in kept {
            // A value in single quotes may hold double ones, in which it is written.
            let value = std::str::from_utf8(&attribute.value).ok()?;
            let value = value.replace('"', "&quot;");
            edited.push_attribute((attribute.key.into_inner(), value.as_bytes()));
        }
        Some(edited)
    }

    /// Writes the description of the camera.
    fn set(&mut self, camera: &RectifiedCamera) -> Option<()> {
        let [right, down] = camera.principal_point_mm;
        let mut text = String::new();
        writeln!(
            text,
            "<rdf:Description rdf:about=\"{}\" xmlns:rdf=\"{RDF}\" xmlns:Camera=\"{}\" \
             Camera:ModelType=\"perspective\" Camera:PerspectiveFocalLength=\"{}\" \
             Camera:PrincipalPoint=\"{right},{down}\" \
             Camera:PerspectiveDistortion=\"0,0,0,0,0\"/>",
            self.about.replace('"', "&quot;"),
            self.namespace,
            camera.focal_length_mm,
        )
        .ok()?;
        self.write(Event::Text(BytesText::from_escaped(text)))
    }
}

fn is_named(local: LocalName<'_>, name: &str) -> bool {
    local.into_inner() == name.as_bytes()
}

fn is_rdf(reader: &NsReader<&[u8]>, element: QName<'_>, name: &str) -> bool {
    let (namespace, local) = reader.resolver().resolve_element(element);
    let is_rdf = matches!(namespace, ResolveResult::Bound(it) if it.into_inner() == RDF.as_bytes());
    is_rdf && is_named(local, name)
}

/// The namespaces of an element are gone with its end; no other element is called `RDF`.
fn is_rdf_end(end: &BytesEnd<'_>) -> bool {
    is_named(end.name().local_name(), "RDF")
}

#[cfg(test)]
mod tests {
    use super::{Packet, RectifiedCamera};

    const CAMERA: RectifiedCamera = RectifiedCamera {
        focal_length_mm: 70.25,
        principal_point_mm: [26.5, 19.75],
    };
    const DESCRIPTION: &str = "<rdf:Description rdf:about=\"u\" \
        xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\" \
        xmlns:Camera=\"http://pix4d.com/camera/1.0/\" Camera:ModelType=\"perspective\" \
        Camera:PerspectiveFocalLength=\"70.25\" Camera:PrincipalPoint=\"26.5,19.75\" \
        Camera:PerspectiveDistortion=\"0,0,0,0,0\"/>\n";

    #[test]
    fn only_keys_of_the_lens_change() {
        let packet = |attributes: &str, elements: &str, camera: &str| {
            format!(
                "<?xpacket begin='' id='W5M0MpCehiHzreSzNTczkc9d'?>\n<x:xmpmeta \
                 xmlns:x='adobe:ns:meta/'>\n <r:RDF \
                 xmlns:r='http://www.w3.org/1999/02/22-rdf-syntax-ns#'>\n  <r:Description \
                 r:about=\"u\" xmlns:p=\"http://pix4d.com/camera/1.0/\" \
                 xmlns:drone-dji=\"http://www.dji.com/drone-dji/1.0/\" \
                 p:Yaw=\"1 &lt; 2\"{attributes}>\n   <p:BandName><r:Seq><r:li>Red &amp; \
                 edge</r:li></r:Seq></p:BandName>{elements}\n  </r:Description>\n \
                 {camera}</r:RDF>\n</x:xmpmeta>\n   \n<?xpacket end='w'?>"
            )
        };
        let input = packet(
            " p:ModelType=\"fisheye\" drone-dji:DewarpFlag=\"1\"",
            "<p:PrincipalPoint>1,2</p:PrincipalPoint><drone-dji:DewarpData>1;2</drone-dji:\
             DewarpData><p:FisheyePolynomial/>",
            "",
        );
        let output = Packet::edited(&input, &CAMERA).unwrap();
        assert_eq!(output.text, packet("", "", DESCRIPTION));
        assert_eq!(
            output.dropped,
            [
                "drone-dji:DewarpFlag",
                "drone-dji:DewarpData",
                "p:FisheyePolynomial"
            ]
        );
        // A second time nothing changes but the place of the camera.
        let again = Packet::edited(&output.text, &CAMERA).unwrap();
        assert!(again.dropped.is_empty());
        assert_eq!(again.text.matches("PrincipalPoint").count(), 1);
    }

    #[test]
    fn what_is_no_packet_is_refused() {
        assert!(Packet::edited("", &CAMERA).is_none());
        assert!(Packet::edited("<a><b></a>", &CAMERA).is_none());
        assert!(Packet::edited("<x:xmpmeta xmlns:x='adobe:ns:meta/'/>", &CAMERA).is_none());
        let new = Packet::of(&CAMERA).unwrap();
        assert!(new.text.contains("Camera:PerspectiveFocalLength=\"70.25\""));
    }
}

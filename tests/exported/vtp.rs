//! A file of XML PolyData read by what its format says, for the tests.

/// The text of a file of a frame.
pub(crate) struct Vtp(pub(crate) String);

impl Vtp {
    /// An attribute of the piece.
    pub(crate) fn count(&self, attribute: &str) -> usize {
        let (_, rest) = self.0.split_once(&format!("{attribute}=\"")).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    }

    /// What stands in the array of this name.
    fn array(&self, name: &str) -> &str {
        let (_, rest) = self.0.split_once(&format!("Name=\"{name}\"")).unwrap();
        let (_, rest) = rest.split_once('>').unwrap();
        rest.split('<').next().unwrap()
    }

    /// The eight bytes of each value of an array, after their length.
    fn eights(&self, name: &str) -> Vec<[u8; 8]> {
        let bytes = decode(self.array(name));
        let eights = bytes.chunks_exact(8);
        let all: Vec<[u8; 8]> = eights.map(|eight| eight.try_into().unwrap()).collect();
        assert_eq!(u64::from_le_bytes(all[0]) as usize + 8, bytes.len());
        all[1..].to_vec()
    }

    pub(crate) fn reals(&self, name: &str) -> Vec<f64> {
        let eights = self.eights(name).into_iter();
        eights.map(f64::from_le_bytes).collect()
    }

    /// Corners of the first cells that are not empty: vertices, lines or polygons.
    pub(crate) fn corners(&self, element: &str) -> Vec<usize> {
        let (_, rest) = self.0.split_once(&format!("<{element}>")).unwrap();
        let cells = Self(rest.to_owned());
        let eights = cells.eights("connectivity").into_iter();
        eights
            .map(|eight| u64::from_le_bytes(eight) as usize)
            .collect()
    }

    pub(crate) fn texts(&self, name: &str) -> Vec<String> {
        let codes = self.array(name).split_whitespace();
        let codes: Vec<u8> = codes.map(|code| code.parse().unwrap()).collect();
        let texts = codes.split(|code| *code == 0);
        let mut texts: Vec<String> = texts
            .map(|text| String::from_utf8(text.to_vec()).unwrap())
            .collect();
        assert_eq!(texts.pop().as_deref(), Some(""));
        texts
    }
}

/// Base64 (RFC 4648).
fn decode(text: &str) -> Vec<u8> {
    let alphabet = ('A'..='Z')
        .chain('a'..='z')
        .chain('0'..='9')
        .chain(['+', '/']);
    let alphabet: Vec<char> = alphabet.collect();
    let (mut bits, mut count, mut bytes) = (0_u32, 0, Vec::new());
    for letter in text.trim_end_matches('=').chars() {
        let value = alphabet.iter().position(|other| *other == letter).unwrap();
        bits = bits << 6 | value as u32;
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    bytes
}

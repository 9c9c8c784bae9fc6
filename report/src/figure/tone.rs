//! Tones and dashes of series: told apart in grey and by those who do not see all colours.

/// How the series of one place in the order look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tone {
    /// Red, green, blue.
    pub rgb: [u8; 3],
    /// Pixels drawn and left out, in turn; empty for a line without gaps.
    pub dashes: &'static [u32],
}

const TONES: [Tone; 8] = [
    tone(0x1b, 0x1b, 0x1b, &[]),
    tone(0xc2, 0x3b, 0x22, &[8, 4]),
    tone(0x2f, 0x6f, 0xb5, &[2, 3]),
    tone(0xe3, 0xa0, 0x1b, &[]),
    tone(0x3f, 0x8f, 0x5f, &[14, 4]),
    tone(0x86, 0x5a, 0xa5, &[10, 3, 2, 3]),
    tone(0x6b, 0xb5, 0xd6, &[]),
    tone(0x8c, 0x8c, 0x8c, &[5, 3]),
];

const fn tone(red: u8, green: u8, blue: u8, dashes: &'static [u32]) -> Tone {
    Tone {
        rgb: [red, green, blue],
        dashes,
    }
}

impl Tone {
    /// The tone of a place in the order; after the last colour they begin anew, with other dashes.
    #[must_use]
    pub fn of(place: usize) -> Self {
        let count = TONES.len();
        Self {
            rgb: TONES[place % count].rgb,
            dashes: TONES[(place + place / count) % count].dashes,
        }
    }

    /// As CSS has it: `#1b1b1b`.
    #[must_use]
    pub fn css(&self) -> String {
        let [red, green, blue] = self.rgb;
        format!("#{red:02x}{green:02x}{blue:02x}")
    }

    /// As CSS has it, so much of it opaque.
    #[must_use]
    pub fn css_with_opacity(&self, opacity: f64) -> String {
        let [red, green, blue] = self.rgb;
        format!("rgba({red},{green},{blue},{opacity})")
    }
}

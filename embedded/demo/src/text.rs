//! Numbers as text: the formatting of floats in `core` has checks that panic, this has none.

/// A line of text: a name, a decimal with four places, and the bits.
pub(crate) struct Text {
    bytes: [u8; 64],
    length: usize,
}

impl Text {
    pub(crate) fn new(name: &str, value: f32) -> Self {
        let mut text = Self { bytes: [b' '; 64], length: 0 };
        for byte in name.bytes().take(24) {
            text.push(byte);
        }
        text.length = 24;
        text.decimal(value);
        text.length = text.length.max(40);
        for place in (0..8).rev() {
            let [digit, ..] = (value.to_bits() >> (4 * place) & 15).to_le_bytes();
            text.push(if digit < 10 { b'0' + digit } else { b'a' - 10 + digit });
        }
        text
    }

    pub(crate) fn as_str(&self) -> &str {
        self.bytes.get(..self.length).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or_default()
    }

    fn push(&mut self, byte: u8) {
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
    }

    /// Four decimals of a number below 100 000.
    fn decimal(&mut self, value: f32) {
        if value < 0.0 {
            self.push(b'-');
        }
        // Exact: 24 bits times 10⁴ are fewer than 53.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "rounded; saturates")]
        let mut rest = (f64::from(value).abs() * 1e4 + 0.5) as u32;
        let mut is_started = false;
        for (place, unit) in
            [100_000_000, 10_000_000, 1_000_000, 100_000, 10_000, 1000, 100, 10, 1].into_iter().enumerate()
        {
            if place == 5 {
                self.push(b'.');
            }
            let mut digit = 0_u8;
            while rest >= unit && digit < 9 {
                rest -= unit;
                digit += 1;
            }
            is_started |= digit > 0 || place >= 4;
            if is_started {
                self.push(b'0' + digit);
            }
        }
    }
}

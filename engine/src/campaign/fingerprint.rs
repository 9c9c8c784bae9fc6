//! Sums over texts: they tell files and lines apart that differ by accident, and are no protection against intent.

/// FNV-1a of 64 bits over parts and their lengths.
#[must_use]
pub fn fingerprint<'a>(parts: impl IntoIterator<Item = &'a [u8]>) -> u64 {
    let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    let mut sum = 0xcbf2_9ce4_8422_2325;
    for (number, part) in parts.into_iter().enumerate() {
        if number > 0 {
            sum = (part.len() as u64).to_le_bytes().iter().fold(sum, step);
        }
        sum = part.iter().fold(sum, step);
    }
    sum
}

/// A line with its end and a sum over it.
#[must_use]
pub fn sealed(content: &str) -> String {
    format!("{content}\t{:016x}\n", fingerprint([content.as_bytes()]))
}

/// What was sealed, of a line without its end; `None` if it is not whole.
#[must_use]
pub fn unsealed(line: &str) -> Option<&str> {
    let (content, sum) = line.rsplit_once('\t')?;
    (sum == format!("{:016x}", fingerprint([content.as_bytes()]))).then_some(content)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors of the algorithm's authors.
    #[test]
    fn fingerprints_are_fnv_1a() {
        assert_eq!(fingerprint([&b""[..]]), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fingerprint([&b"a"[..]]), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fingerprint([&b"foobar"[..]]), 0x8594_4171_f739_67e8);
        assert_ne!(
            fingerprint([&b"ab"[..], b"c"]),
            fingerprint([&b"a"[..], b"bc"])
        );
    }

    #[test]
    fn torn_and_changed_lines_have_another_sum() {
        let line = sealed("7\tdone");
        let whole = line.trim_end_matches('\n');
        assert_eq!(unsealed(whole), Some("7\tdone"));
        assert!((0..whole.len()).all(|end| unsealed(&whole[..end]).is_none()));
        assert_eq!(unsealed(&whole.replace('7', "8")), None);
    }
}

//! URIs inside glTF files: relative references and embedded data.    \[RFC3986], \[RFC2397]

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

const BASE64: GeneralPurpose =
    GeneralPurpose::new(&STANDARD, GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent));

/// What a URI stands for.
#[derive(Debug, PartialEq)]
pub enum Target {
    /// Bytes inside the URI itself.
    Data(Vec<u8>),
    /// A path relative to the file, percent-decoded.
    Path(String),
}

/// Resolves a URI, or says what is wrong with it.
pub fn resolve(uri: &str) -> Result<Target, String> {
    if let Some(data) = uri.get(..5).filter(|scheme| scheme.eq_ignore_ascii_case("data:")).map(|_| &uri[5..]) {
        let (media_type, payload) = data.split_once(',').ok_or("the data URI has no comma before its data")?;
        return if media_type.ends_with(";base64") {
            BASE64.decode(payload).map(Target::Data).map_err(|error| format!("the data URI is not valid base64: {error}"))
        } else {
            percent_decode(payload).map(Target::Data)
        };
    }
    if let Some((scheme, _)) = uri.split_once(':').filter(|(scheme, _)| is_scheme(scheme)) {
        return Err(format!("the URI has the scheme `{scheme}`, but only relative paths and `data:` are read"));
    }
    let path = percent_decode(uri)?;
    let path = String::from_utf8(path).map_err(|_| format!("the URI `{}` is not UTF-8", short(uri)))?;
    if path.is_empty() || path.starts_with('/') || path.starts_with('\\') || path.contains('\0') {
        return Err(format!("the URI `{}` is not a relative path", short(uri)));
    }
    Ok(Target::Path(path))
}

/// A letter, then letters, digits, `+`, `-` and `.`; one letter alone is a Windows drive, which is no relative path either.
fn is_scheme(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
}

fn percent_decode(text: &str) -> Result<Vec<u8>, String> {
    let mut bytes = text.bytes();
    let mut decoded = Vec::with_capacity(text.len());
    while let Some(byte) = bytes.next() {
        decoded.push(if byte == b'%' {
            let mut digit = || bytes.next().and_then(|digit| char::from(digit).to_digit(16));
            let (high, low) = digit().zip(digit()).ok_or_else(|| format!("the URI `{}` has a `%` without two digits", short(text)))?;
            (high * 16 + low) as u8
        } else {
            byte
        });
    }
    Ok(decoded)
}

/// The beginning of a URI, for messages.
pub fn short(uri: &str) -> String {
    if uri.chars().count() > 60 { uri.chars().take(57).chain("...".chars()).collect() } else { uri.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_paths_are_percent_decoded() {
        assert_eq!(resolve("my%20textures/a%C3%A4.png"), Ok(Target::Path("my textures/aä.png".into())));
        assert_eq!(resolve("../shared/a+b.bin"), Ok(Target::Path("../shared/a+b.bin".into())));
    }

    #[test]
    fn data_uris_are_decoded_with_and_without_base64_and_padding() {
        assert_eq!(resolve("data:application/octet-stream;base64,AAEC/w=="), Ok(Target::Data(vec![0, 1, 2, 255])));
        assert_eq!(resolve("data:;base64,AAEC/w"), Ok(Target::Data(vec![0, 1, 2, 255])));
        assert_eq!(resolve("DATA:text/plain,a%20b"), Ok(Target::Data(b"a b".to_vec())));
    }

    #[test]
    fn what_is_no_relative_path_is_refused() {
        for uri in
            ["http://example.org/a.bin", "file:///etc/passwd", "C:\\a.bin", "/etc/passwd", "\\\\server\\a", "", "a%2", "a%zz", "a%ff.bin"]
        {
            assert!(resolve(uri).is_err(), "{uri}");
        }
        for uri in ["data:;base64", "data:;base64,@@@@", "data:,%"] {
            assert!(resolve(uri).is_err(), "{uri}");
        }
    }
}

//! Text and data inside HTML.

use serde_json::Value;

/// Text as HTML shows it word for word, also within attributes.
#[must_use]
pub fn text_in_html(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            letter => out.push(letter),
        }
    }
    out
}

/// JSON for a script element: nothing in it can end the element.
#[must_use]
pub fn json_in_html(value: &Value) -> String {
    value.to_string().replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn nothing_ends_the_element_early() {
        let name = "</script><b a='1' b=\"2\">&";
        assert!(!json_in_html(&json!({"name": name})).contains('<'));
        let back: Value = serde_json::from_str(&json_in_html(&json!(name))).unwrap();
        assert_eq!(back, json!(name));
        assert_eq!(
            text_in_html(name),
            "&lt;/script&gt;&lt;b a=&#39;1&#39; b=&quot;2&quot;&gt;&amp;"
        );
    }
}

//! Rust source as identifiers and punctuation with line numbers; comments, strings and characters are left out.

/// An identifier or one punctuation character.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// Its text.
    pub text: String,
    /// Line, from 1.
    pub line: usize,
}

/// Splits source text. Made for sources that compile; of others it makes some sense as well.
pub fn tokens(source: &str) -> Vec<Token> {
    let c: Vec<char> = source.chars().collect();
    let mut list = Vec::new();
    let (mut i, mut line) = (0, 1);
    while i < c.len() {
        let start = i;
        let next = c.get(i + 1).copied().unwrap_or(' ');
        if c[i] == '/' && next == '/' {
            while i < c.len() && c[i] != '\n' {
                i += 1;
            }
        } else if c[i] == '/' && next == '*' {
            i = after_block_comment(&c, i);
        } else if let Some(end) = after_raw_string(&c, i) {
            i = end;
        } else if c[i] == '"' || (c[i] == 'b' && next == '"') {
            i = after_quoted(&c, if c[i] == 'b' { i + 1 } else { i }, '"');
        } else if c[i] == '\'' && is_character(&c, i) {
            i = after_quoted(&c, i, '\'');
        } else if c[i].is_alphanumeric() || c[i] == '_' {
            while i < c.len() && (c[i].is_alphanumeric() || c[i] == '_') {
                i += 1;
            }
            list.push(Token { text: c[start..i].iter().collect(), line });
        } else {
            i += 1;
            if !c[start].is_whitespace() {
                list.push(Token { text: c[start].to_string(), line });
            }
        }
        line += c[start..i].iter().filter(|c| **c == '\n').count();
    }
    list
}

/// Block comments nest.
fn after_block_comment(c: &[char], start: usize) -> usize {
    let (mut i, mut depth) = (start, 0);
    while i < c.len() {
        match (c[i], c.get(i + 1)) {
            ('/', Some('*')) => {
                depth += 1;
                i += 2;
            }
            ('*', Some('/')) => {
                depth -= 1;
                i += 2;
                if depth == 0 {
                    return i;
                }
            }
            _ => i += 1,
        }
    }
    i
}

/// The end of `r"..."`, `r#"..."#`, `br"..."` that begins here.
fn after_raw_string(c: &[char], start: usize) -> Option<usize> {
    if start > 0 && (c[start - 1].is_alphanumeric() || c[start - 1] == '_') {
        return None;
    }
    let mut i = start + usize::from(c[start] == 'b');
    if c.get(i) != Some(&'r') {
        return None;
    }
    i += 1;
    let hashes = c[i..].iter().take_while(|c| **c == '#').count();
    i += hashes;
    if c.get(i) != Some(&'"') {
        return None;
    }
    i += 1;
    while i < c.len() && !(c[i] == '"' && c[i + 1..].iter().take_while(|c| **c == '#').count() >= hashes) {
        i += 1;
    }
    Some((i + 1 + hashes).min(c.len()))
}

fn after_quoted(c: &[char], start: usize, quote: char) -> usize {
    let mut i = start + 1;
    while i < c.len() && c[i] != quote {
        i += if c[i] == '\\' { 2 } else { 1 };
    }
    (i + 1).min(c.len())
}

/// `'x'` and `'\n'` are characters, `'static` is a lifetime.
fn is_character(c: &[char], start: usize) -> bool {
    c.get(start + 1) == Some(&'\\') || c.get(start + 2) == Some(&'\'')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_strings_and_characters_are_left_out() {
        let source =
            "a /* x /* y */ z */ b // crate::c\n\"crate::d \\\" \" 'e' '\\'' r#\"f \" g\"# h::<'i>\nj";
        let found: Vec<(String, usize)> = tokens(source).into_iter().map(|t| (t.text, t.line)).collect();
        let expected = [
            ("a", 1),
            ("b", 1),
            ("h", 2),
            (":", 2),
            (":", 2),
            ("<", 2),
            ("'", 2),
            ("i", 2),
            (">", 2),
            ("j", 3),
        ];
        assert_eq!(found, expected.map(|(t, l)| (t.to_string(), l)));
    }
}

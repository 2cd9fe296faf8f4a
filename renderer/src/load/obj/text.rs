//! The lines of OBJ and MTL files.

/// A statement.
pub(super) struct Line<'a> {
    /// Its line in the file, from 1.
    pub(super) number: usize,
    /// Its first word.
    pub(super) keyword: &'a str,
    /// What follows, without white space around it.
    pub(super) rest: &'a str,
}

/// The statements of a file, without comments and empty lines. A backslash at the end of a line
/// joins the next one to it.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let mut rest = text;
    let mut next_number = 1;
    std::iter::from_fn(move || {
        while !rest.is_empty() {
            let number = next_number;
            let mut end = 0;
            loop {
                let line = rest[end..].split_inclusive('\n').next().unwrap_or_default();
                end += line.len();
                next_number += 1;
                if !line.trim_end().ends_with('\\') {
                    break;
                }
            }
            let (line, after) = rest.split_at(end);
            rest = after;
            let line = line.trim();
            let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            if !keyword.is_empty() && !keyword.starts_with('#') {
                return Some(Line { number, keyword, rest: rest.trim_start() });
            }
        }
        None
    })
}

/// The words of a statement, up to a comment.
pub(super) fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split(|c: char| c.is_whitespace() || c == '\\')
        .filter(|word| !word.is_empty())
        .take_while(|word| !word.starts_with('#'))
}

/// A number; also one that is not finite.
pub(super) fn number(word: &str) -> Option<f32> {
    word.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements() {
        let text = "\r\n v 1  2 \\\r\n 3\n# c\n\tg a #b \r\nf\nx\\";
        let found: Vec<_> = lines(text).map(|l| (l.number, l.keyword, l.rest)).collect();
        assert_eq!(
            found,
            [(2, "v", "1  2 \\\r\n 3"), (5, "g", "a #b"), (6, "f", ""), (7, "x\\", "")]
        );
        assert_eq!(words(found[0].2).collect::<Vec<_>>(), ["1", "2", "3"]);
        assert_eq!(words("1/2 3 # 4").collect::<Vec<_>>(), ["1/2", "3"]);
    }
}

//! Texts as words of a shell.

/// A word of a POSIX shell that stands for the text: as it is if nothing in it has a meaning for a shell, in
/// single quotes otherwise.
pub(crate) fn shell_word(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=,+@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.to_owned();
    }
    format!("'{}'", text.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shell gives every text back as it was.
    #[cfg(unix)]
    #[test]
    fn a_shell_reads_words_as_they_were() {
        let texts = [
            "plain/path-1.toml",
            "two words",
            "",
            "it's",
            "'",
            "a\"b\\c",
            "$HOME `id` $(id) !! * ? ~ #",
            "{ a = [1, 2] } & | ; < >",
            "ä % {} {1} %s",
        ];
        let words: Vec<String> = texts.iter().map(|t| shell_word(t)).collect();
        let line = format!("printf '%s\\n' {}", words.join(" "));
        let output = std::process::Command::new("sh")
            .args(["-c", &line])
            .output();
        let output = String::from_utf8(output.unwrap().stdout).unwrap();
        assert_eq!(output, texts.join("\n") + "\n");
        assert_eq!(words[0], texts[0]);
    }
}

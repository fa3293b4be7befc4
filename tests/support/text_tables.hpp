#pragma once

#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

namespace conelane::tests {

/// The lines below a heading `[name]` of a text file.
struct TableSection {
    std::string name;
    std::vector<std::string> lines;
    friend void PrintTo(const TableSection& section, std::ostream* out) { *out << section.name; }
};

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

inline std::vector<std::string> split(const std::string& text, const std::string& separator) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0;; begin += parts.back().size() + separator.size()) {
        const std::size_t end = text.find(separator, begin);
        parts.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
        if (end == std::string::npos) return parts;
    }
}

/// The sections of a file below tests/. Lines that are blank or begin with # count nothing; after a line
/// `NAME = TEXT`, with capitals, $NAME stands for the text.
inline std::vector<TableSection> table_sections(const std::string& file) {
    std::vector<TableSection> all;
    std::vector<std::pair<std::string, std::string>> texts;
    std::istringstream stream(source_text("tests/" + file));
    for (std::string line; std::getline(stream, line);) {
        if (line.empty() || line.starts_with('#')) continue;
        for (const auto& [name, text] : texts) line = replaced(line, "$" + name, text);
        const std::size_t capitals = line.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ");
        if (capitals > 0 && capitals != std::string::npos && line.substr(capitals).starts_with(" = "))
            texts.insert(texts.begin(), {line.substr(0, capitals), line.substr(capitals + 3)});
        else if (line.starts_with('[') && line.ends_with(']') && line.find(' ') == std::string::npos)
            all.push_back({line.substr(1, line.size() - 2), {}});
        else
            all.back().lines.push_back(line);
    }
    return all;
}

}  // namespace conelane::tests

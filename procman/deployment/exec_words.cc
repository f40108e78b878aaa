#include "procman/deployment/exec_words.h"

#include <cstddef>
#include <stdexcept>

namespace waymark {
namespace {

// A word before variables are put in. What stood behind a backslash is no
// variable's $.
struct RawWord {
  std::string text;
  std::vector<bool> is_plain;

  void Add(char c, bool plain) {
    text += c;
    is_plain.push_back(plain);
  }
};

bool IsBlank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool IsNameStart(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool IsNamePart(char c) {
  return IsNameStart(c) || (c >= '0' && c <= '9');
}

std::vector<RawWord> RawWordsOf(std::string_view exec) {
  std::vector<RawWord> words;
  RawWord word;
  bool is_word = false;  // Also an empty one, of two quotes.
  char quote = '\0';
  for (std::size_t i = 0; i < exec.size(); ++i) {
    const char c = exec[i];
    if (c == '\0') throw std::invalid_argument("exec holds a zero byte");
    if (c == '\\') {
      if (++i == exec.size()) {
        throw std::invalid_argument("exec ends with a backslash");
      }
      word.Add(exec[i], false);
      is_word = true;
    } else if (quote != '\0') {
      if (c == quote) {
        quote = '\0';
      } else {
        word.Add(c, true);
      }
    } else if (c == '"' || c == '\'') {
      quote = c;
      is_word = true;
    } else if (!IsBlank(c)) {
      word.Add(c, true);
      is_word = true;
    } else if (is_word) {
      words.push_back(word);
      word = {};
      is_word = false;
    }
  }
  if (quote != '\0') {
    throw std::invalid_argument(std::string("exec: a quote ") + quote +
                                " has no end");
  }
  if (is_word) words.push_back(word);
  return words;
}

// Position of the = of NAME=VALUE; npos where it is none.
std::size_t AssignmentEnd(const std::string& text) {
  if (text.empty() || !IsNameStart(text[0])) return std::string::npos;
  std::size_t i = 1;
  while (i < text.size() && IsNamePart(text[i])) ++i;
  return i < text.size() && text[i] == '=' ? i : std::string::npos;
}

std::string Expanded(const RawWord& word, const FindVariable& variables) {
  const std::string& text = word.text;
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const auto keep = [&] { result += text[i++]; };
    if (text[i] != '$' || !word.is_plain[i] || i + 1 == text.size()) {
      keep();
      continue;
    }
    const bool has_brace = text[i + 1] == '{';
    const std::size_t begin = i + (has_brace ? 2 : 1);
    std::size_t end = begin;
    while (end < text.size() && IsNamePart(text[end])) ++end;
    const bool is_name =
        end > begin && IsNameStart(text[begin]) &&
        (!has_brace || (end < text.size() && text[end] == '}'));
    const auto value = is_name ? variables(text.substr(begin, end - begin))
                               : std::optional<std::string>();
    if (!value) {
      keep();
      continue;
    }
    result += *value;
    i = end + (has_brace ? 1 : 0);
  }
  return result;
}

}  // namespace

ExecWords SplitExec(std::string_view exec, const FindVariable& variables) {
  ExecWords result;
  for (const RawWord& word : RawWordsOf(exec)) {
    const std::size_t equals = AssignmentEnd(word.text);
    if (result.words.empty() && equals != std::string::npos) {
      result.environment.emplace_back(word.text.substr(0, equals),
                                      word.text.substr(equals + 1));
    } else {
      result.words.push_back(Expanded(word, variables));
    }
  }
  if (result.words.empty() || result.words[0].empty()) {
    throw std::invalid_argument("exec names no program");
  }
  return result;
}

}  // namespace waymark

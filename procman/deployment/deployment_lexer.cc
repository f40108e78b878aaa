#include "procman/deployment/deployment_lexer.h"

#include "estimation/base/input_error.h"

#include <fmt/format.h>

#include <utility>

namespace waymark {
namespace {

// Not those of <cctype>, which ask the locale.
bool IsLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

}  // namespace

std::string Token::Described() const {
  switch (kind) {
    case TokenKind::kString:
      return "\"" + text + "\"";
    case TokenKind::kEnd:
      return "end of file";
    default:
      return "'" + text + "'";
  }
}

DeploymentLexer::DeploymentLexer(std::string_view text, std::string source)
    : text_(text), source_(std::move(source)) {}

void DeploymentLexer::Refuse(const TextPlace& place,
                             const std::string& message) const {
  throw InputError(
      fmt::format("{}:{}:{}: {}", source_, place.line, place.column, message));
}

char DeploymentLexer::Peek() const {
  return at_ < text_.size() ? text_[at_] : '\0';
}

char DeploymentLexer::Take() {
  const char c = text_[at_++];
  if (c == '\n') {
    ++place_.line;
    place_.column = 1;
  } else {
    ++place_.column;
  }
  return c;
}

void DeploymentLexer::SkipBlanks() {
  while (at_ < text_.size()) {
    const char c = Peek();
    if (c == '#') {
      while (at_ < text_.size() && Peek() != '\n') Take();
    } else if (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
      Take();
    } else {
      return;
    }
  }
}

Token DeploymentLexer::String(Token token) {
  token.kind = TokenKind::kString;
  Take();
  while (true) {
    if (at_ == text_.size()) Refuse(token.place, "a string has no end");
    const TextPlace place = place_;
    const char c = Take();
    if (c == '"') return token;
    if (c == '\n' || c == '\0') {
      Refuse(place,
             c == '\n' ? "a string goes on over the end of its line; use \\n"
                       : "a string holds a zero byte");
    }
    if (c != '\\') {
      token.text += c;
      continue;
    }
    if (at_ == text_.size()) Refuse(token.place, "a string has no end");
    const char escaped = Take();
    if (escaped == '\n' || escaped == '\0') {
      Refuse(place, "'\\' at the end of a line");
    }
    token.text += escaped == 'n'   ? '\n'
                  : escaped == 'r' ? '\r'
                  : escaped == 't' ? '\t'
                                   : escaped;
  }
}

Token DeploymentLexer::Next() {
  SkipBlanks();
  Token token;
  token.place = place_;
  if (at_ == text_.size()) return token;
  const char c = Peek();
  if (c == '"') return String(std::move(token));
  if (IsLetter(c)) {
    token.kind = TokenKind::kIdentifier;
    while (IsLetter(Peek()) || IsDigit(Peek()) || Peek() == '-') {
      token.text += Take();
    }
    return token;
  }
  if (IsDigit(c)) {
    token.kind = TokenKind::kInteger;
    while (IsDigit(Peek())) token.text += Take();
    return token;
  }
  if (c == '{' || c == '}' || c == '=' || c == ';') {
    token.kind = TokenKind::kSymbol;
    token.text = Take();
    return token;
  }
  Refuse(place_,
         c > ' ' && c <= '~' ? fmt::format("unexpected '{}'", c)
                             : fmt::format("unexpected byte {:#04x}",
                                           static_cast<unsigned char>(c)));
}

}  // namespace waymark

// Words of a deployment file. Internal to its parser.
#pragma once

#include "procman/deployment/deployment_types.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace waymark {

enum class TokenKind : std::uint8_t {
  kIdentifier,  // [A-Za-z_][A-Za-z0-9_-]*
  kString,      // Within double quotes; \n \r \t, and \x for any other x.
  kInteger,     // [0-9]+
  kSymbol,      // One of { } = ;
  kEnd,
};

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::string text;  // Of a string: without quotes and escapes.
  TextPlace place;

  [[nodiscard]] bool Is(char symbol) const {
    return kind == TokenKind::kSymbol && text[0] == symbol;
  }
  // As a reader would name it: 'exec', "a b", end of file.
  [[nodiscard]] std::string Described() const;
};

class DeploymentLexer {
 public:
  // `source` names the text in errors.
  DeploymentLexer(std::string_view text, std::string source);

  // After the last one kEnd, again and again. Throws InputError.
  [[nodiscard]] Token Next();

  [[noreturn]] void Refuse(const TextPlace& place,
                           const std::string& message) const;

 private:
  [[nodiscard]] char Peek() const;
  char Take();
  void SkipBlanks();
  Token String(Token token);

  std::string_view text_;
  std::string source_;
  std::size_t at_ = 0;
  TextPlace place_;
};

}  // namespace waymark

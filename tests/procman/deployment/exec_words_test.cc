#include "procman/deployment/exec_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::Pair;

std::optional<std::string> Variable(std::string_view name) {
  if (name == "HOME") return "/home/me";
  if (name == "EMPTY") return "";
  if (name == "TWO") return "a b";
  return std::nullopt;
}

std::vector<std::string> Words(std::string_view exec) {
  return SplitExec(exec, Variable).words;
}

TEST(ExecWords, SplitsAtBlanksOutsideQuotes) {
  EXPECT_THAT(Words("  run  -a\t'b c' \"d  e\"f '' "),
              ElementsAre("run", "-a", "b c", "d  ef", ""));
  EXPECT_THAT(Words("bash -c 'sleep 3 | cat; echo \"x\"'"),
              ElementsAre("bash", "-c", "sleep 3 | cat; echo \"x\""));
}

TEST(ExecWords, ABackslashTakesTheNextCharacter) {
  EXPECT_THAT(Words(R"(run a\ b \"c\" 'd\'e' \\ x\ty)"),
              ElementsAre("run", "a b", "\"c\"", "d'e", "\\", "xty"));
}

TEST(ExecWords, PutsInVariablesOfTheProgramAndItsArguments) {
  EXPECT_THAT(Words("$HOME/bin/run ${HOME}x '$HOME' $TWO"),
              ElementsAre("/home/me/bin/run", "/home/mex", "/home/me", "a b"));
  // What is no variable stays as it is; so does what was escaped.
  EXPECT_THAT(
      Words("bash -c 'echo [$0] $NOT ${NOT} ${HOME $ $1' \\$HOME"),
      ElementsAre("bash", "-c", "echo [$0] $NOT ${NOT} ${HOME $ $1", "$HOME"));
  EXPECT_THAT(Words("run a${EMPTY}b"), ElementsAre("run", "ab"));
  // Not in what was put in.
  EXPECT_THAT(
      SplitExec("run $A", [](std::string_view) { return std::string("$A $A"); })
          .words,
      ElementsAre("run", "$A $A"));
}

TEST(ExecWords, LeadingAssignmentsAreOfTheEnvironment) {
  const ExecWords e = SplitExec("A=1 B_2='x y' C= D=$HOME run E=5", Variable);
  EXPECT_THAT(e.environment,
              ElementsAre(Pair("A", "1"),
                          Pair("B_2", "x y"),
                          Pair("C", ""),
                          Pair("D", "$HOME")));
  EXPECT_THAT(e.words, ElementsAre("run", "E=5"));
  // No name before the =: a program.
  EXPECT_THAT(Words("./a=b c"), ElementsAre("./a=b", "c"));
  EXPECT_THAT(Words("=b c"), ElementsAre("=b", "c"));
}

TEST(ExecWords, RefusesWhatCannotBeRun) {
  for (const std::string& exec : {std::string(),
                                  std::string("  "),
                                  std::string("A=1"),
                                  std::string("''"),
                                  std::string("run 'a"),
                                  std::string("run \"a"),
                                  std::string("run a\\"),
                                  std::string("run\0x", 5)}) {
    EXPECT_THROW((void)SplitExec(exec, Variable), std::invalid_argument)
        << exec;
  }
}

}  // namespace
}  // namespace waymark

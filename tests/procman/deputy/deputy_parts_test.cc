#include "estimation/base/random.h"
#include "procman/deputy/clean_text.h"
#include "procman/deputy/output_gate.h"
#include "procman/deputy/proc_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <string>
#include <vector>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

std::string Cleaned(const std::string& bytes) {
  CleanText clean;
  std::string text = clean.Add(bytes);
  return text + clean.Finish();
}

TEST(CleanText, LeavesTextAsItIs) {
  const std::string text =
      "a\tb\n\x1B[31mred\x1B[0m \xC3\xA9\xE2\x82\xAC"
      "\xF0\x9F\xA4\x96\n";
  EXPECT_EQ(Cleaned(text), text);
}

TEST(CleanText, ReplacesWhatIsNoCharacter) {
  const std::string r = "\xEF\xBF\xBD";
  EXPECT_EQ(Cleaned(std::string("a\0b", 3)), "a" + r + "b");
  EXPECT_EQ(Cleaned("\xFF"
                    "a"),
            r + "a");
  EXPECT_EQ(Cleaned("\xC0\x80"), r + r);          // Too long a form.
  EXPECT_EQ(Cleaned("\xED\xA0\x80"), r + r + r);  // Half a surrogate pair.
  EXPECT_EQ(Cleaned("\xE2\x82"
                    "a"),
            r + "a");
  EXPECT_EQ(Cleaned("\xE2\x82"), r);
  EXPECT_EQ(Cleaned("\xF5\x80"), r + r);
}

TEST(CleanText, OfALineEndOnlyTheFeedIsLeft) {
  EXPECT_EQ(Cleaned("a\r\nb\rc\r"), "a\nb\rc\r");
}

// However it is cut, the same comes out, and it is valid.
TEST(CleanText, CutsMakeNoDifference) {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    std::string bytes;
    for (int i = 0; i < 60; ++i) {
      bytes += static_cast<char>(
          random.Index(2) == 0
              ? "\xE2\x82\xAC\xF0\x9F\xA4\x96\r\n\xC3\xA9z"[random.Index(12)]
              : static_cast<char>(random.Index(256)));
    }
    const std::string whole = Cleaned(bytes);
    CleanText clean;
    std::string pieces;
    for (std::size_t i = 0; i < bytes.size();) {
      const std::size_t size = 1 + random.Index(5);
      pieces += clean.Add(bytes.substr(i, size));
      i += size;
    }
    pieces += clean.Finish();
    ASSERT_EQ(pieces, whole);
    // All that is left is text: nothing more is replaced.
    const auto without_returns = [](std::string text) {
      std::erase(text, '\r');
      return text;
    };
    ASSERT_EQ(without_returns(Cleaned(whole)), without_returns(whole));
  }
}

TEST(OutputGate, SendsWhatIsFullAtOnceAndTheRestAfterAWhile) {
  OutputGate gate;
  EXPECT_FALSE(gate.next());
  gate.Add("a", "one\n", seconds(5));
  gate.Add("b", "two\n", seconds(5));
  gate.Add("a", "three\n", seconds(5));
  // The last message was long ago.
  const auto first = gate.Take(seconds(5));
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[0].command_id, "a");
  EXPECT_EQ(first[0].text, "one\nthree\n");
  EXPECT_EQ(first[1].text, "two\n");
  gate.Add("a", "four\n", seconds(5));
  EXPECT_TRUE(gate.Take(seconds(5)).empty());
  EXPECT_EQ(*gate.next(), seconds(5) + milliseconds(10));
  gate.Add("a", std::string(5000, 'x'), seconds(5));
  EXPECT_EQ(gate.Take(seconds(5)).size(), 1u);
}

TEST(OutputGate, LeavesOutWhatIsTooMuchAndSaysHowMuch) {
  OutputGateOptions options;
  options.bytes_per_second = 1000;
  options.burst_bytes = 100;
  OutputGate gate(options);
  gate.Add("a", std::string(30, 'x') + "\n" + std::string(99, 'y'), seconds(1));
  EXPECT_EQ(gate.Take(seconds(1))[0].text, std::string(30, 'x') + "\n");
  EXPECT_EQ(gate.num_dropped_bytes(), 99);
  // Another's budget is its own.
  gate.Add("b", "fine\n", seconds(1));
  EXPECT_EQ(gate.Take(seconds(2))[0].text, "fine\n");
  gate.Add("a", "again\n", seconds(2));
  EXPECT_EQ(gate.Take(seconds(3))[0].text,
            "[99 bytes of output left out here]\nagain\n");
  // Never within a character.
  OutputGate small(options);
  std::string euros;
  for (int i = 0; i < 50; ++i) euros += "\xE2\x82\xAC";
  small.Add("a", euros, seconds(1));
  EXPECT_EQ(small.Take(seconds(1))[0].text, euros.substr(0, 99));
}

TEST(ProcTable, ReadsBehindTheLastBracket) {
  const auto stat = ParseProcessStat(
      "4321 (a) b (x)) S 1 4321 4320 34816 4321 4194304 100 0 0 0 "
      "17 5 0 0 20 0 1 0 987654 12345678 321 18446744073709551615 1 1\n");
  ASSERT_TRUE(stat);
  EXPECT_EQ(stat->pid, 4321);
  EXPECT_EQ(stat->name, "a) b (x)");
  EXPECT_EQ(stat->state, 'S');
  EXPECT_EQ(stat->parent, 1);
  EXPECT_EQ(stat->session, 4320);
  EXPECT_EQ(stat->user_ticks, 17u);
  EXPECT_EQ(stat->system_ticks, 5u);
  EXPECT_EQ(stat->start_ticks, 987654u);
  EXPECT_EQ(stat->virtual_bytes, 12345678u);
  EXPECT_EQ(stat->resident_pages, 321);
  for (const char* text : {"", "1", "1 (a", "1 (a) S", "x (a) S 1 2 3", ")("}) {
    EXPECT_FALSE(ParseProcessStat(text)) << text;
  }
}

TEST(ProcTable, KnowsThisProcessAndTheMachine) {
  const auto processes = ReadProcesses();
  const auto self = std::find_if(
      processes.begin(), processes.end(), [](const ProcessStat& process) {
        return process.pid == getpid();
      });
  ASSERT_NE(self, processes.end());
  EXPECT_EQ(self->parent, getppid());
  EXPECT_GT(self->resident_pages, 0);
  const auto ticks = ParseMachineTicks(ReadKernelFile("/proc/stat"));
  ASSERT_TRUE(ticks);
  EXPECT_GT(ticks->idle, 0u);
  const MachineMemory memory =
      ParseMachineMemory(ReadKernelFile("/proc/meminfo"));
  EXPECT_GT(memory.total_bytes, memory.free_bytes);
  EXPECT_GT(memory.free_bytes, 0);
  EXPECT_FALSE(ParseMachineTicks("cpux 1 2 3 4"));
  EXPECT_FALSE(ParseMachineTicks(""));
}

TEST(ProcTable, DescendantsAreThoseOfParentsAndOfTheSession) {
  const auto process = [](std::int32_t pid,
                          std::int32_t parent,
                          std::int32_t session,
                          char state = 'S') {
    ProcessStat stat;
    stat.pid = pid;
    stat.parent = parent;
    stat.session = session;
    stat.state = state;
    return stat;
  };
  const std::vector<ProcessStat> processes{
      process(30, 20, 30),  // Of a session of its own.
      process(10, 1, 10),   // The leader.
      process(20, 10, 10),
      process(21, 1, 10),  // Its parent has ended.
      process(22, 10, 10, 'Z'),
      process(40, 1, 40),  // Somebody else.
      process(41, 21, 41)};
  std::vector<std::int32_t> pids;
  for (const auto& found : DescendantsOf(10, processes)) {
    pids.push_back(found.pid);
  }
  EXPECT_THAT(pids, testing::UnorderedElementsAre(20, 21, 30, 41));
}

}  // namespace
}  // namespace waymark

#include "processes/support/run_tool.h"

#include "estimation/base/input_error.h"
#include "processes/support/output_file.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>

namespace waymark {
namespace {

constexpr int kFault = 1;
constexpr int kBadInput = 2;

void PrintError(const std::string& name, std::string what) {
  std::replace(what.begin(), what.end(), '\n', ' ');
  std::fprintf(stderr, "%s: %s\n", name.c_str(), what.c_str());
}

// CLI11 does not say which commands there are.
std::string MissingCommand(const CLI::App& app, int argc, char** argv) {
  std::string text;
  if (argc > 1) text = std::string("'") + argv[1] + "' is none; ";
  std::string list;
  for (const auto* command : app.get_subcommands(nullptr)) {
    list += (list.empty() ? "" : ", ") + command->get_name();
  }
  return text + "needs a command: " + list;
}

}  // namespace

int RunTool(int argc,
            char** argv,
            const std::string& name,
            const std::string& description,
            const std::function<void(CLI::App* app, int* exit_code)>& add) {
  int exit_code = 0;
  CLI::App app(description, name);
  try {
    add(&app, &exit_code);
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);  // Prints what --help asks for.
  } catch (const CLI::ParseError& error) {
    const bool has_command =
        app.get_require_subcommand_min() == 0 || !app.get_subcommands().empty();
    PrintError(name,
               (has_command ? error.what() : MissingCommand(app, argc, argv)) +
                   " (see --help)");
    return kBadInput;
  } catch (const InputError& error) {
    PrintError(name, error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    PrintError(name, std::string("fault: ") + error.what());
    return kFault;
  }
  return exit_code;
}

CLI::Option* RequireRange(CLI::Option* option, double min, double max) {
  const std::string range =
      "[" + ShortestNumber(min) + ", " + ShortestNumber(max) + "]";
  return option->check(
      [=](const std::string& text) {
        double value = 0.0;
        const bool is_number = CLI::detail::lexical_cast(text, value);
        if (is_number && value >= min && value <= max) return std::string();
        return "'" + text + "' is not a number in " + range;
      },
      "in " + range);
}

}  // namespace waymark

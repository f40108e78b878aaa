#include "logs/log_tool/csv_export.h"

#include "estimation/base/input_error.h"
#include "processes/support/log_file.h"
#include "processes/support/message_fields.h"
#include "processes/support/output_file.h"
#include "processes/support/progress.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <type_traits>
#include <unordered_map>
#include <utility>

namespace waymark {
namespace {

using TableKey = std::pair<std::string, std::string>;  // Channel, type.

struct Table {
  std::vector<std::string> columns;
  std::unordered_map<std::string, std::size_t> index;
  std::unique_ptr<OutputFile> file;
  std::int64_t num_rows = 0;
  bool is_too_wide = false;
};

std::string QuotedCsv(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    return std::string(text);
  }
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string CsvText(const FieldValue& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, bool>) {
          return v ? "1" : "0";
        } else if constexpr (std::is_arithmetic_v<T>) {
          return ShortestNumber(v);
        } else if constexpr (std::is_same_v<T, std::string_view>) {
          return QuotedCsv(v);
        } else {
          return std::to_string(v.size());  // Bytes.
        }
      },
      value);
}

std::string FileNamePart(std::string text) {
  std::replace(text.begin(), text.end(), '/', '_');
  return text;
}

class CsvExporter {
 public:
  CsvExporter(std::string log, TypeTable* types)
      : log_(std::move(log)), types_(types) {}

  // Arrays differ in length between messages, so the columns are known only
  // after a first reading.
  void FindColumns() {
    ForEachMessage(
        "looking through ",
        [&](Table* table, const MessageSchema& schema, const LogEvent& event) {
          if (table->is_too_wide) return true;
          const std::string reason = VisitFields(
              schema,
              event.data,
              [&](std::string_view name, const FieldValue&) {
                if (table->columns.size() > kMaxCsvColumns) return;
                const auto [column, is_new] = table->index.try_emplace(
                    std::string(name), table->columns.size());
                if (is_new) table->columns.push_back(column->first);
              });
          table->is_too_wide = table->columns.size() > kMaxCsvColumns;
          return reason.empty();
        });
  }

  void OpenFiles(const std::string& folder, IfExists if_exists) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!std::filesystem::is_directory(folder)) {
      throw InputError(folder + ": cannot be made a folder: " +
                       (error ? error.message() : "something else is there"));
    }
    std::map<std::string, int> num_types;
    for (const auto& [key, table] : tables_) ++num_types[key.first];
    for (auto& [key, table] : tables_) {
      if (table.is_too_wide || table.columns.empty()) continue;
      std::string name = FileNamePart(key.first);
      if (num_types[key.first] > 1) name += "." + FileNamePart(key.second);
      name += ".csv";
      const auto path = (std::filesystem::path(folder) / name).string();
      CheckOutput(path, if_exists, {&log_, 1});
      table.file = std::make_unique<OutputFile>(path, if_exists);
      std::string header = "event_utime";
      for (const auto& column : table.columns) header.append(1, ',') += column;
      table.file->Write(header + "\n");
    }
  }

  void WriteRows() {
    std::vector<std::string> cells;
    ForEachMessage(
        "exporting ",
        [&](Table* table, const MessageSchema& schema, const LogEvent& event) {
          if (table->file == nullptr) return true;
          cells.assign(table->columns.size(), "");
          const std::string reason = VisitFields(
              schema,
              event.data,
              [&](std::string_view name, const FieldValue& value) {
                cells[table->index.at(std::string(name))] = CsvText(value);
              });
          if (!reason.empty()) return false;
          std::string row = std::to_string(Microseconds(event.time));
          for (const auto& cell : cells) row.append(1, ',') += cell;
          table->file->Write(row + "\n");
          ++table->num_rows;
          return true;
        });
  }

  CsvReport Finish() {
    CsvReport report;
    report.num_undecodable = num_undecodable_;
    for (auto& [key, table] : tables_) {
      if (table.is_too_wide) {
        report.left_out.push_back(key.first + ": a message has more than " +
                                  std::to_string(kMaxCsvColumns) + " values");
      }
      if (table.file == nullptr) continue;
      table.file->Close();
      report.files.push_back({table.file->path(), table.num_rows});
    }
    for (const auto& [channel, type] : unknown_) {
      std::string reason = channel;
      reason += ": its type is not known: ";
      report.left_out.push_back(reason += type);
    }
    return report;
  }

 private:
  // `handle` says whether the message decoded.
  template <typename Handle>
  void ForEachMessage(const char* what, const Handle& handle) {
    LogReader reader(log_);
    Progress progress(what + log_, reader.report().num_file_bytes);
    num_undecodable_ = 0;
    while (const auto event = reader.Next()) {
      progress.Show(reader.offset());
      const MessageTypeInfo& type = types_->Find(event->data);
      if (type.schema == nullptr) {
        unknown_.insert({event->channel, type.name});
        continue;
      }
      Table& table = tables_[{event->channel, type.schema->name}];
      if (!handle(&table, *type.schema, *event)) ++num_undecodable_;
    }
  }

  std::string log_;
  TypeTable* types_;
  std::map<TableKey, Table> tables_;
  std::set<TableKey> unknown_;
  std::int64_t num_undecodable_ = 0;
};

}  // namespace

CsvReport ExportCsv(const std::string& log,
                    const std::string& folder,
                    TypeTable* types,
                    IfExists if_exists) {
  CsvExporter exporter(log, types);
  exporter.FindColumns();
  exporter.OpenFiles(folder, if_exists);
  exporter.WriteRows();
  return exporter.Finish();
}

}  // namespace waymark

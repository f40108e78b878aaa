// Decoder of any type by its schema, against the generated decoder where there
// is one: both must take and refuse the same bytes. The first byte chooses the
// type.
#include "processes/support/decode.h"
#include "processes/support/message_fields.h"
#include "processes/support/message_schema.h"
#include "tests/fuzz/fuzz_target.h"

#include <waymark_all_types.hpp>

#include <map>

namespace waymark::fuzz {
namespace {

const SchemaSet& BuiltIn() {
  static const SchemaSet kSet(BuiltInSchemaSources());
  return kSet;
}

using Accepts = bool (*)(Bytes);

const std::map<std::uint64_t, Accepts>& Generated() {
  static const std::map<std::uint64_t, Accepts> kAccepts = {
#define ACCEPTS(package, type)                                              \
  {static_cast<std::uint64_t>(::package::type::getHash()), [](Bytes data) { \
     return DecodeMessage<::package::type>(data).has_value();               \
   }},
      WAYMARK_FOR_EACH_MESSAGE_TYPE(ACCEPTS)
#undef ACCEPTS
  };
  return kAccepts;
}

}  // namespace

void RunOne(Bytes data) {
  if (data.empty()) return;
  const auto& types = BuiltIn().types();
  const MessageSchema& schema = *types[data[0] % types.size()];
  const std::uint64_t fingerprint = Fingerprint(schema);
  const auto message = WithFingerprint(fingerprint, data.subspan(1));
  std::size_t num_values = 0;
  const std::string reason =
      VisitFields(schema, message, [&](std::string_view name, const auto&) {
        Expect(!name.empty(), "a value has a name");
        ++num_values;
      });
  const auto generated = Generated().find(fingerprint);
  if (generated == Generated().end()) return;
  Expect(reason.empty() == generated->second(message),
         "by schema and generated: " + schema.name + ": " + reason);
}

std::vector<std::string> Seeds() {
  std::vector<std::string> seeds;
  for (std::size_t i = 0; i < BuiltIn().types().size(); ++i) {
    // Empty arrays and texts of length 1: zeros are a good start for all.
    for (const std::size_t size : {8u, 64u, 200u}) {
      seeds.push_back(std::string(1, static_cast<char>(i)) +
                      std::string(size, '\0'));
    }
  }
  return seeds;
}

}  // namespace waymark::fuzz

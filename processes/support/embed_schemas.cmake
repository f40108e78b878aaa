# cmake -DOUT=x.cc -DFILES=a.lcm,b.lcm -DROOT=dir -P embed_schemas.cmake
# Writes the definitions' texts into a source file, so that tools know the
# types wherever they are installed.
string(REPLACE "," ";" FILES "${FILES}")
set(_entries "")
foreach(_file ${FILES})
  file(READ ${_file} _text)
  file(RELATIVE_PATH _name ${ROOT} ${_file})
  # Brackets and semicolons are what CMake itself would interpret; appending
  # a quoted string does not.
  string(APPEND _entries "      {\"${_name}\", R\"lcm(${_text})lcm\"},\n")
endforeach()
file(WRITE ${OUT} "#include \"processes/support/message_schema.h\"

namespace waymark {

std::vector<SchemaSet::Source> BuiltInSchemaSources() {
  return {
${_entries}  };
}

}  // namespace waymark
")

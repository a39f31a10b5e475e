# Writes a C++ file that holds text files as string literals: cmake -DOUTPUT=... -DROOT=... -DFILES=a;b -P embed.cmake
# FILES are relative to ROOT; a leading "src/" is dropped from the names that the program sees.
set(text "// Made by cmake/embed.cmake; do not edit.\n#include \"core/resources.hpp\"\n\nnamespace apeiron {\n\n")
string(APPEND text "const std::vector<Resource>& resources() {\n    static const std::vector<Resource> all{\n")
list(SORT FILES)
foreach(file IN LISTS FILES)
  file(READ "${ROOT}/${file}" content)
  string(REGEX REPLACE "^src/" "" name "${file}")
  string(APPEND text "        {\"${name}\", R\"APEIRON_TEXT(${content})APEIRON_TEXT\"},\n")
endforeach()
string(APPEND text "    };\n    return all;\n}\n\n} // namespace apeiron\n")
file(WRITE "${OUTPUT}.new" "${text}")
file(COPY_FILE "${OUTPUT}.new" "${OUTPUT}" ONLY_IF_DIFFERENT)
file(REMOVE "${OUTPUT}.new")

#pragma once

#include "core/json.hpp"

#include <map>
#include <string>

namespace apeiron::parameter {

/// A parsed JSON text that remembers where each value stands.
class JsonSource {
  public:
    /// `//` and `/* */` comments are allowed. @param file a name for messages
    /// @throws Error (BadInput) at file:line:column for broken JSON, a key given twice, and nesting deeper than
    /// kMaxDepth.
    static JsonSource parse(std::string file, const std::string& text);

    const Json& root() const { return root_; }
    const std::string& file() const { return file_; }
    /// "file:line (pointer)" of the value at a JSON pointer such as "/camera/fov"; of its nearest known parent
    /// otherwise.
    std::string where(const std::string& pointer) const;

    /// The pointer of a member or element: `pointer` + "/" + the escaped key.
    static std::string child(const std::string& pointer, const std::string& key);

    static constexpr int kMaxDepth = 200;

  private:
    std::string file_;
    Json root_;
    std::map<std::string, int> lines_; ///< JSON pointer -> line, from 1
};

} // namespace apeiron::parameter

#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace apeiron {

/// What kind of expected failure an Error reports; front ends map it to an exit code.
enum class ErrorKind {
    BadInput,  ///< a scene, option, value or shader source of the user's is wrong
    Io,        ///< a file cannot be read or written
    NoContext, ///< no usable GPU context could be made
    Gpu,       ///< the GPU failed while working: lost context, out of memory
};

/// An expected failure: what happened, where, and what to do about it, in one line.
///
/// Programmer errors are asserted, never thrown.
class Error : public std::runtime_error {
  public:
    /// @param what  what is wrong, as a phrase without a final full stop
    /// @param where the place: `file:line`, a JSON pointer, an option; may be empty
    /// @param hint  what the user can do about it; may be empty
    Error(ErrorKind kind, const std::string& what, const std::string& where = {}, const std::string& hint = {});

    ErrorKind kind() const { return kind_; }

    /// The same error, seen from a wider place: `where` is put in front of the message.
    Error at(const std::string& where) const;

  private:
    Error(ErrorKind kind, const std::string& message, int);
    ErrorKind kind_;
};

/// The text in double quotes for a message: shortened when long, control characters as '?'.
std::string inQuotes(std::string_view text);

} // namespace apeiron

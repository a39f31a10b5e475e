#pragma once

#include "parameter/parameter.hpp"

namespace apeiron::parameter {

/// An ordered set of parameters with distinct names.
class Schema {
  public:
    /// A Module parameter that invalidates Samples (what a declaration says by saying nothing) becomes Program: other
    /// code always needs other kernels. @throws Error (BadInput) naming both places when the name is taken, and when
    /// the default value is not valid.
    void add(Parameter parameter);
    void add(const std::vector<Parameter>& parameters);

    /// nullptr when there is none of that name.
    const Parameter* find(std::string_view name) const;
    /// @throws Error (BadInput) "unknown parameter 'x'" with the nearest name as a hint.
    const Parameter& at(std::string_view name) const;

    std::vector<std::string> names() const;
    auto begin() const { return parameters_.begin(); }
    auto end() const { return parameters_.end(); }
    std::size_t size() const { return parameters_.size(); }

  private:
    std::vector<Parameter> parameters_;
};

} // namespace apeiron::parameter

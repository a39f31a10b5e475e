#pragma once

#include <CLI/CLI.hpp>

#include <functional>

// The subcommands: each adds its options to the parser and, when it is the one that was given, sets what to do.
namespace apeiron::cli {

// What the program ends with.
inline constexpr int kDone = 0;
inline constexpr int kInternal = 1;      ///< anything that should not happen, such as no memory
inline constexpr int kBadInput = 2;      ///< a wrong option, scene or file
inline constexpr int kNoGpu = 3;         ///< no usable GPU context, or the GPU failed
inline constexpr int kInterrupted = 130; ///< by the user; what there was is saved

/// Runs the chosen command. @returns an exit code. @throws Error
using Action = std::function<int()>;

void addRenderCommand(CLI::App& app, Action& action);
void addListCommand(CLI::App& app, Action& action);
void addInfoCommand(CLI::App& app, Action& action);
void addCheckCommand(CLI::App& app, Action& action);
void addSchemaCommand(CLI::App& app, Action& action);
void addMergeCommand(CLI::App& app, Action& action);
void addBenchCommand(CLI::App& app, Action& action);
void addTerrainCommand(CLI::App& app, Action& action);
void addDiveCommand(CLI::App& terrain, Action& action); ///< of `terrain`

} // namespace apeiron::cli

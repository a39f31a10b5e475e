#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace apeiron {

/// The whole file as bytes. @throws Error (Io) when it is missing, a folder, unreadable or larger than `limit` bytes.
std::string readFile(const std::filesystem::path& path, std::size_t limit = std::size_t{64} << 20);

/// Writes a file so that `path` is either the complete new content or what it was before: `write` is
/// given a temporary name in the same folder with the same extension, which then replaces `path`.
/// The temporary file is removed when `write` throws or the rename fails; missing parent folders are an error.
/// @throws Error (Io), and whatever `write` throws.
void writeAtomically(const std::filesystem::path& path,
                     const std::function<void(const std::filesystem::path& temporary)>& write);

/// writeAtomically() for content that is already in memory.
void writeFile(const std::filesystem::path& path, std::string_view content);

/// Checks early that `path` could be written (its folder exists and takes new files; it is not a folder itself),
/// so that a long computation does not end in an error. @throws Error (Io).
void requireWritable(const std::filesystem::path& path);

} // namespace apeiron

// Formats of other programs that are not read, by what their files look like.
#pragma once

#include <string>
#include <string_view>

namespace isochor::mesh_files {

// What the file is and what to do with it, as "this is a FEBio model; ..."; empty when nothing tells.
// `extension`: lower case, with its dot.
std::string foreign_format(std::string_view content, std::string_view extension, const std::string& file);

}  // namespace isochor::mesh_files

// Affine transforms of scene files. Column vectors: p' = M p.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "kernels/host/error.h"

namespace penumbra {

glm::dmat4 translation(glm::dvec3 offset);
glm::dmat4 scaling(glm::dvec3 factors);

/// Right-handed rotation by `degrees` about `axis`, of any non-zero length (Rodrigues' formula).
glm::dmat4 rotation(glm::dvec3 axis, double degrees);

/// A camera at `origin` that sees `target` along its +z, with `up` in its upper half plane and +x to the left
/// of the image. Without `up`, some direction across the view. Errors: origin equals target, `up` is along
/// the view.
Expected<glm::dmat4> look_at(glm::dvec3 origin, glm::dvec3 target, std::optional<glm::dvec3> up);

/// 16 numbers of a 4×4 matrix, or 9 of its upper left 3×3 part, row by row. Errors: another count, a last row
/// other than 0 0 0 1 (no perspective).
Expected<glm::dmat4> matrix_from_rows(std::span<const double> numbers);

/// Whether the transform flattens space, or cannot be told from one that does.
bool is_singular(const glm::dmat4& transform);

/// Whether it turns left-handed frames into right-handed ones.
bool is_mirror(const glm::dmat4& transform);

/// The common factor by which the transform scales all lengths along its first `axes` axes (3: in space, 2:
/// in the xy-plane), if it is a similarity there (within 1e-4, for matrices written with few digits).
std::optional<double> uniform_scale(const glm::dmat4& transform, int axes = 3);

/// The same frame with unit axes. Errors: the axes are not at right angles.
Expected<glm::dmat4> without_scale(const glm::dmat4& transform);

glm::dvec3 transform_point(const glm::dmat4& transform, glm::dvec3 point);
glm::dvec3 transform_vector(const glm::dmat4& transform, glm::dvec3 vector);

/// For normals: the inverse transpose, but for a positive factor.
glm::dmat3 normal_matrix(const glm::dmat4& transform);

}  // namespace penumbra

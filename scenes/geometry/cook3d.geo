// Cook's membrane as a solid: a tapered panel 48 x 44 (16 at the end) x 10 mm.
//
// Unit: meter (the usual figures in millimeters times 1e-3; moduli and tractions
// are then in Pa: 80.194 N/mm^2 = 80.194e6 Pa). The panel lies in the x-y plane,
// 0 <= z <= 0.010. It is graded toward the held edge, most at its upper corner,
// where stress is singular. A plane at mid-thickness is meshed too, so that the
// probes (48, 60, 5) and (48, 52, 5) mm are nodes.
//
// Regions: body. Surfaces: clamped (x = 0), loaded (x = 48 mm), faces (z = 0 and
// z = 10 mm), edges (upper and lower).
SetFactory("Built-in");
DefineConstant[ h = {0.0062, Name "Parameters/target edge length away from the held edge [m]"} ];
Include "options.geo";

mm = 1e-3;
thickness = 10 * mm;

Point(1) = {0, 0, 0, 0.7 * h};
Point(2) = {48 * mm, 44 * mm, 0, h};
Point(3) = {48 * mm, 52 * mm, 0, h};
Point(4) = {48 * mm, 60 * mm, 0, 0.9 * h};
Point(5) = {0, 44 * mm, 0, 0.4 * h};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 1};
Curve Loop(1) = {1, 2, 3, 4, 5};
Plane Surface(1) = {1};
lower() = Extrude{0, 0, thickness / 2}{ Surface{1}; };
upper() = Extrude{0, 0, thickness / 2}{ Surface{lower(0)}; };

// An extrusion lists: far face, volume, then one side for each curve of the loop.
Physical Volume("body", 1) = {lower(1), upper(1)};
Physical Surface("clamped", 2) = {lower(6), upper(6)};
Physical Surface("loaded", 3) = {lower(3), lower(4), upper(3), upper(4)};
Physical Surface("faces", 4) = {1, upper(0)};
Physical Surface("edges", 5) = {lower(2), upper(2), lower(5), upper(5)};

ReverseMesh Surface{1};    // so that every surface faces outward

// Thick tube in plane strain: a quarter of the ring 1 <= r <= 2, a slab one layer
// of elements thick; hold u_z = 0 on "faces_z".
//
// Unit: meter (lengths are relative to the inner radius of 1). Axis z, the quarter
// x, y >= 0, 0 <= z <= thickness. With -order 2 the nodes of curved edges lie on
// the true cylinders.
//
// Regions: body. Surfaces: inner, outer, symmetry_x (x = 0, hold u_x),
// symmetry_y (y = 0, hold u_y), faces_z.
SetFactory("Built-in");
DefineConstant[ h = {0.11, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

inner_radius = 1;
outer_radius = 2;
thickness = h;    // one layer of well-shaped elements

Point(1) = {0, 0, 0};
Point(2) = {inner_radius, 0, 0, h * 0.7};
Point(3) = {outer_radius, 0, 0, h * 1.2};
Point(4) = {0, outer_radius, 0, h * 1.2};
Point(5) = {0, inner_radius, 0, h * 0.7};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
slab() = Extrude{0, 0, thickness}{ Surface{1}; Layers{1}; };

// An extrusion lists: far face, volume, then one side for each curve of the loop.
Physical Volume("body", 1) = {slab(1)};
Physical Surface("inner", 2) = {slab(5)};
Physical Surface("outer", 3) = {slab(3)};
Physical Surface("symmetry_x", 4) = {slab(4)};
Physical Surface("symmetry_y", 5) = {slab(2)};
Physical Surface("faces_z", 6) = {1, slab(0)};

ReverseMesh Surface{1};    // so that every surface faces outward

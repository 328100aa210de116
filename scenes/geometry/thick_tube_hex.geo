// Thick tube in plane strain, see thick_tube.geo, in hexahedra: n through the wall, 2n around the quarter.
//
// Regions: body. Surfaces: inner, outer, symmetry_x (x = 0, hold u_x),
// symmetry_y (y = 0, hold u_y), faces_z.
SetFactory("Built-in");
DefineConstant[ n = {8, Name "Parameters/boxes through the wall"} ];
Include "options.geo";

Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {2, 0, 0};
Point(4) = {0, 2, 0};
Point(5) = {0, 1, 0};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {5, 4};
Circle(4) = {2, 1, 5};
Curve Loop(1) = {1, 2, -3, -4};
Plane Surface(1) = {1};
Transfinite Curve{1, 3} = n + 1 Using Progression 2^(1 / n);
Transfinite Curve{2, 4} = 2 * n + 1;
Transfinite Surface{1};
Recombine Surface{1};
slab() = Extrude{0, 0, 1 / n}{ Surface{1}; Layers{1}; Recombine; };

Physical Volume("body", 1) = {slab(1)};
Physical Surface("inner", 2) = {slab(5)};
Physical Surface("outer", 3) = {slab(3)};
Physical Surface("symmetry_x", 4) = {slab(4)};
Physical Surface("symmetry_y", 5) = {slab(2)};
Physical Surface("faces_z", 6) = {1, slab(0)};

ReverseMesh Surface{1};    // so that every surface faces outward

// Arm: soft tissue around a straight bone.
//
// Unit: meter. The bone is a hole along x, from x = 0 to the other end.
//
// Regions: body. Surfaces: bone (the hole), skin (outside), ends.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.0125, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

length = 0.20;
middle = 0.045;  // radius of the skin in the middle
end = 0.034;     // and at the ends
bone = 0.012;

p = newp;
Point(p) = {0, bone, 0};
Point(p + 1) = {length, bone, 0};
Point(p + 2) = {length, end, 0};
Point(p + 3) = {length / 2, middle, 0};
Point(p + 4) = {0, end, 0};
l = newl;
Line(l) = {p, p + 1};
Line(l + 1) = {p + 1, p + 2};
Spline(l + 2) = {p + 2, p + 3, p + 4};
Line(l + 3) = {p + 4, p};
Curve Loop(1) = {l, l + 1, l + 2, l + 3};
Plane Surface(1) = {1};
first() = Extrude{ {1, 0, 0}, {0, 0, 0}, Pi }{ Surface{1}; };
second() = Extrude{ {1, 0, 0}, {0, 0, 0}, -Pi }{ Surface{1}; };
BooleanUnion{ Volume{first(1)}; Delete; }{ Volume{second(1)}; Delete; }
Recursive Delete { Surface{1}; }

small = 1e-5;
Physical Volume("body") = Volume{:};
a() = Surface In BoundingBox{-small, -1, -1, small, 1, 1};
b() = Surface In BoundingBox{length - small, -1, -1, length + small, 1, 1};
core() = Surface In BoundingBox{-small, -bone - small, -bone - small, length + small, bone + small, bone + small};
every() = Surface{:};
every() -= {a()};
every() -= {b()};
every() -= {core()};
Physical Surface("bone") = {core()};
Physical Surface("skin") = {every()};
Physical Surface("ends") = {a(), b()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{1};

// Cantilever 0.1 x 0.1 x 1 m, unstructured.
//
// Unit: meter. The beam fills 0 <= x <= 1, 0 <= y, z <= 0.1; gravity is -y. The
// center of the free end (1, 0.05, 0.05), where deflection is measured, is a node.
//
// Regions: body. Surfaces: clamped (x = 0), free_end (x = 1), sides.
SetFactory("OpenCASCADE");
DefineConstant[ h = {0.0520, Name "Parameters/target edge length [m]"} ];
Include "options.geo";

length = 1;
side = 0.1;

Box(1) = {0, 0, 0,  length, side, side};
probe = newp;
Point(probe) = {length, side / 2, side / 2};
all() = BooleanFragments{ Volume{1}; Delete; }{ Point{probe}; Delete; };

e = 1e-5;
skin() = Abs(Boundary{ Volume{1}; });
clamped() = Surface In BoundingBox {-e, -e, -e,  e, side + e, side + e};
free_end() = Surface In BoundingBox {length - e, -e, -e,  length + e, side + e, side + e};
sides() = skin();
sides() -= clamped();
sides() -= free_end();

Physical Volume("body", 1) = {1};
Physical Surface("clamped", 2) = {clamped()};
Physical Surface("free_end", 3) = {free_end()};
Physical Surface("sides", 4) = {sides()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
ReorientMesh Volume{1};

// Source of the block_* files: a block of two regions with a hole inside, a marked face and a marked corner.
// Volume 1.5 - 0.4^3. Written by Gmsh 4.8, for example: gmsh -3 -order 2 -format msh41 -bin block.geo
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Box(2) = {0.3, 0.3, 0.3, 0.4, 0.4, 0.4};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Box(4) = {1, 0, 0, 0.5, 1, 1};
Coherence;
Physical Volume("soft part", 10) = {3};
Physical Volume("hard", 20) = {4};
cavity() = Surface In BoundingBox{0.2, 0.2, 0.2, 0.8, 0.8, 0.8};
Physical Surface("cavity", 5) = {cavity()};
left() = Surface In BoundingBox{-0.1, -0.1, -0.1, 0.1, 1.1, 1.1};
Physical Surface("left", 6) = {left()};
corner() = Point In BoundingBox{-0.1, -0.1, -0.1, 0.1, 0.1, 0.1};
Physical Point("corner", 7) = {corner()};
Mesh.CharacteristicLengthMin = 0.9;
Mesh.CharacteristicLengthMax = 1;

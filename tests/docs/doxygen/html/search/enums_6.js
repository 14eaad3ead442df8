var searchData=
[
  ['robustkernel_0',['RobustKernel',['../icp__parameters_8hpp.html#af05079babb25a0c2f5f3d2a286278649',1,'agrisee']]]
];

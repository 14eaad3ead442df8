var searchData=
[
  ['pose_0',['Pose',['../pose_8hpp.html#a5f6174a8658222723db921457c2edffa',1,'agrisee']]]
];

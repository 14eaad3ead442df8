var searchData=
[
  ['matrix3_0',['Matrix3',['../types_8hpp.html#ae6dee4d49363fd7eeb778c65870dc7b7',1,'agrisee']]]
];

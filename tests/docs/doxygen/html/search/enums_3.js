var searchData=
[
  ['nonfinite_0',['NonFinite',['../cloud__file_8hpp.html#a0d38750bf7b7feadc76f6be15dfce836',1,'agrisee::io']]]
];

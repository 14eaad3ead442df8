var searchData=
[
  ['agrisee_5fabi_0',['AGRISEE_ABI',['../compiled_8hpp.html#ac7f7a75a78f168651b58fb18a34dcac0',1,'compiled.hpp']]],
  ['agrisee_5fjoin_1',['AGRISEE_JOIN',['../compiled_8hpp.html#af0554d4ebca7703f485315ff8b054680',1,'compiled.hpp']]],
  ['agrisee_5fjoin_5ftokens_2',['AGRISEE_JOIN_TOKENS',['../compiled_8hpp.html#a107c076ab169a707b317e8bc390b44ae',1,'compiled.hpp']]],
  ['agrisee_5fversion_3',['AGRISEE_VERSION',['../version_8hpp.html#aa4e925ce93769a64ab292ad55113f4f1',1,'version.hpp']]]
];

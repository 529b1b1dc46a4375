#include "io/unicode_letters.h"

#include <cstddef>
#include <string>
#include <unordered_map>
#include <utility>

#include "io/text_encoding.h"

namespace aligngs {
namespace {

/// Letters that Unicode writes in two ways: as one character, or as another letter and a mark behind it. `letters` has
/// pairs: the one character, then its letter. The decompositions are those of Unicode 15 (UnicodeData.txt).
struct MarkedLetters {
  char32_t mark;
  std::u32string_view letters;
};
constexpr MarkedLetters kMarked[] = {
    {0x0300, U"ÀAÈEÌIÒOÙUàaèeìiòoùuǛÜǜüǸNǹnЀЕЍИѐеѝиḔĒḕēṐŌṑōẀWẁwẦÂầâẰĂằăỀÊềêỒÔồôỜƠờơỪƯừưỲYỳy"},
    {0x0301, U"ÁAÉEÍIÓOÚUÝYáaéeíióoúuýyĆCćcĹLĺlŃNńnŔRŕrŚSśsŹZźzǗÜǘüǴGǵgǺÅǻåǼÆǽæǾØǿø΅¨ΆΑΈΕΉΗΊΙΌΟΎΥΏΩ"},
    {0x0301, U"ΐϊάαέεήηίιΰϋόούυώωϓϒЃГЌКѓгќкḈÇḉçḖĒḗēḮÏḯïḰKḱkḾMḿmṌÕṍõṒŌṓōṔPṕpṸŨṹũẂWẃwẤÂấâẮĂắăẾÊếêỐÔốô"},
    {0x0301, U"ỚƠớơỨƯứư"},
    {0x0302, U"ÂAÊEÎIÔOÛUâaêeîiôoûuĈCĉcĜGĝgĤHĥhĴJĵjŜSŝsŴWŵwŶYŷyẐZẑzẬẠậạỆẸệẹỘỌộọ"},
    {0x0303, U"ÃAÑNÕOãañnõoĨIĩiŨUũuṼVṽvẪÂẫâẴĂẵăẼEẽeỄÊễêỖÔỗôỠƠỡơỮƯữưỸYỹy"},
    {0x0304, U"ĀAāaĒEēeĪIīiŌOōoŪUūuǕÜǖüǞÄǟäǠȦǡȧǢÆǣæǬǪǭǫȪÖȫöȬÕȭõȰȮȱȯȲYȳyӢИӣиӮУӯуḠGḡgḸḶḹḷṜṚṝṛ"},
    {0x0306, U"ĂAăaĔEĕeĞGğgĬIĭiŎOŏoŬUŭuЎУЙИйиўуӁЖӂжӐАӑаӖЕӗеḜȨḝȩẶẠặạ"},
    {0x0307, U"ĊCċcĖEėeĠGġgİIŻZżzȦAȧaȮOȯoḂBḃbḊDḋdḞFḟfḢHḣhṀMṁmṄNṅnṖPṗpṘRṙrṠSṡsṤŚṥśṦŠṧšṨṢṩṣṪTṫtẆWẇwẊX"},
    {0x0307, U"ẋxẎYẏyẛſ"},
    {0x0308, U"ÄAËEÏIÖOÜUäaëeïiöoüuÿyŸYΪΙΫΥϊιϋυϔϒЁЕЇІёеїіӒАӓаӚӘӛәӜЖӝжӞЗӟзӤИӥиӦОӧоӪӨӫөӬЭӭэӰУӱуӴЧӵчӸЫ"},
    {0x0308, U"ӹыḦHḧhṎÕṏõṺŪṻūẄWẅwẌXẍxẗt"},
    {0x0309, U"ẢAảaẨÂẩâẲĂẳăẺEẻeỂÊểêỈIỉiỎOỏoỔÔổôỞƠởơỦUủuỬƯửưỶYỷy"},
    {0x030a, U"ÅAåaŮUůuẘwẙy"},
    {0x030b, U"ŐOőoŰUűuӲУӳу"},
    {0x030c, U"ČCčcĎDďdĚEěeĽLľlŇNňnŘRřrŠSšsŤTťtŽZžzǍAǎaǏIǐiǑOǒoǓUǔuǙÜǚüǦGǧgǨKǩkǮƷǯʒǰjȞHȟh"},
    {0x030f, U"ȀAȁaȄEȅeȈIȉiȌOȍoȐRȑrȔUȕuѶѴѷѵ"},
    {0x0311, U"ȂAȃaȆEȇeȊIȋiȎOȏoȒRȓrȖUȗu"},
    {0x031b, U"ƠOơoƯUưu"},
    {0x0323, U"ḄBḅbḌDḍdḤHḥhḲKḳkḶLḷlṂMṃmṆNṇnṚRṛrṢSṣsṬTṭtṾVṿvẈWẉwẒZẓzẠAạaẸEẹeỊIịiỌOọoỢƠợơỤUụuỰƯựưỴYỵy"},
    {0x0324, U"ṲUṳu"},
    {0x0325, U"ḀAḁa"},
    {0x0326, U"ȘSșsȚTțt"},
    {0x0327, U"ÇCçcĢGģgĶKķkĻLļlŅNņnŖRŗrŞSşsŢTţtȨEȩeḐDḑdḨHḩh"},
    {0x0328, U"ĄAąaĘEęeĮIįiŲUųuǪOǫo"},
    {0x032d, U"ḒDḓdḘEḙeḼLḽlṊNṋnṰTṱtṶUṷu"},
    {0x032e, U"ḪHḫh"},
    {0x0330, U"ḚEḛeḬIḭiṴUṵu"},
    {0x0331, U"ḆBḇbḎDḏdḴKḵkḺLḻlṈNṉnṞRṟrṮTṯtẔZẕzẖh"},
    {0x3099, U"がかぎきぐくげけごこざさじしずすぜせぞそだたぢちづつでてどとばはびひぶふべへぼほゔう"},
    {0x3099, U"ゞゝガカギキグクゲケゴコザサジシズスゼセゾソダタヂチヅツデテドトバハビヒブフベヘボホ"},
    {0x3099, U"ヴウヷワヸヰヹヱヺヲヾヽ"},
    {0x309a, U"ぱはぴひぷふぺへぽほパハピヒプフペヘポホ"},
};

using Decompositions = std::unordered_map<char32_t, std::pair<char32_t, char32_t>>;

const Decompositions& decompositions() {
  static const Decompositions kAll = [] {
    Decompositions all;
    for (const MarkedLetters& row : kMarked) {
      for (size_t i = 0; i + 1 < row.letters.size(); i += 2) all[row.letters[i]] = {row.letters[i + 1], row.mark};
    }
    return all;
  }();
  return kAll;
}

/// Appends the decomposed form of a character.
void decompose(char32_t c, std::u32string& out) {
  // Hangul syllables are numbered by their parts (Unicode 3.12): 588 for each first consonant, 28 for each vowel.
  constexpr char32_t kSyllables = 0xac00, kCount = 11172, kFirst = 0x1100, kVowel = 0x1161, kLast = 0x11a7;
  if (c >= kSyllables && c < kSyllables + kCount) {
    const char32_t index = c - kSyllables;
    out.push_back(kFirst + index / 588);
    out.push_back(kVowel + index % 588 / 28);
    if (index % 28 != 0) out.push_back(kLast + index % 28);
    return;
  }
  const auto found = decompositions().find(c);
  if (found == decompositions().end()) {
    out += c >= U'A' && c <= U'Z' ? c - U'A' + U'a' : c;
    return;
  }
  decompose(found->second.first, out);
  out += found->second.second;
}

}  // namespace

std::string common_spelling(std::string_view name) {
  std::u32string letters;
  for (const char32_t c : characters_of_utf8(as_utf8(name))) decompose(c, letters);
  return utf8_of_characters(letters);
}

}  // namespace aligngs
